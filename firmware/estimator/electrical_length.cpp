#include "estimator/electrical_length.hpp"

#include <cmath>

namespace rfmvo {

ElectricalLength electrical_length_from_hops(const std::vector<std::vector<TimedPhase>>& chains) {
  constexpr double kMaxPairGap_s = 0.35;  // the cart moves less than about a wavelength's quarter in it
  constexpr double kMaxLength_m = 40.0;   // of cable and reader together
  constexpr double kStep_m = 0.1;
  struct Pair {
    double phase_rad, term_rad_m;
  };
  std::vector<Pair> pairs;
  for (const auto& chain : chains)
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const double term = chain[i].frequency_term_rad_m - chain[i - 1].frequency_term_rad_m;
      if (std::abs(term) > 1e-6 && chain[i].time_s - chain[i - 1].time_s < kMaxPairGap_s)
        pairs.push_back({chain[i].phase_rad - chain[i - 1].phase_rad, term});
    }
  ElectricalLength best;
  if (pairs.empty()) return best;
  for (double length = 0.0; length <= kMaxLength_m; length += kStep_m) {
    double sum = 0.0;
    for (const Pair& p : pairs) sum += std::cos(p.phase_rad - p.term_rad_m * length);
    sum /= static_cast<double>(pairs.size());
    if (sum > best.coherence) best = {length, sum, sum * std::sqrt(2.0 * static_cast<double>(pairs.size()))};
  }
  return best;
}

}  // namespace rfmvo
