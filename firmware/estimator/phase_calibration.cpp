#include "estimator/phase_calibration.hpp"

#include <cmath>

#include "base/units.hpp"

namespace rfmvo {
namespace {

constexpr double kFirstLength_m = 0.0;
// 25 cm is 0.02 rad over one 500 kHz channel and 0.27 rad over the 26 MHz of the widest band.
constexpr double kLengthStep_m = 0.25;
constexpr std::int64_t kMinHops = 40;
// |sum|^2 / hops is 1 on average by chance, and above 16 once in 10^7 times: e^-16 per candidate.
constexpr double kMinSignificance = 16.0;
constexpr double kMaxGap_s = 0.5;  // farther apart, the motion between the reads hides the slope

double candidate_m(int n) { return kFirstLength_m + kLengthStep_m * n; }

double frequency_step_hz(const TagRead& before, const TagRead& after) {
  return static_cast<double>(after.frequency_hz) - static_cast<double>(before.frequency_hz);
}

// Phase of an electrical length over a frequency step: 4 pi l df / c.
double phase_of(double length_m, double frequency_step) {
  return 2.0 * kTwoPi * length_m * frequency_step / kSpeedOfLight_m_s;
}

}  // namespace

void PhaseCalibration::on_pair(const TagRead& before, const TagRead& after) {
  const double df = frequency_step_hz(before, after);
  if (df == 0.0 || (after.time - before.time).seconds() > kMaxGap_s) return;
  Port& port = ports_[after.port];
  const double step = after.phase.rad() - before.phase.rad();
  // exp(j (step - slope * length)) over equally spaced lengths is a geometric sequence.
  std::complex<double> value = std::polar(1.0, step - phase_of(kFirstLength_m, df));
  const std::complex<double> turn = std::polar(1.0, -phase_of(kLengthStep_m, df));
  int best = 0;
  for (int n = 0; n < kLengths; ++n) {
    auto& sum = port.sums[static_cast<std::size_t>(n)];
    sum += value;
    value *= turn;
    if (std::norm(sum) > std::norm(port.sums[static_cast<std::size_t>(best)])) best = n;
  }
  ++port.hops;
  // The size of the sum, not its real part: motion towards the tag turns all steps alike.
  const double significance = std::norm(port.sums[static_cast<std::size_t>(best)]) / static_cast<double>(port.hops);
  port.best = port.hops >= kMinHops && significance >= kMinSignificance ? best : -1;
}

std::optional<double> PhaseCalibration::excess_length_m(std::uint8_t port) const {
  const auto found = ports_.find(port);
  if (found == ports_.end() || found->second.best < 0) return std::nullopt;
  return candidate_m(found->second.best);
}

std::optional<double> PhaseCalibration::phase_step_rad(const TagRead& before, const TagRead& after) const {
  const double df = frequency_step_hz(before, after);
  if (df == 0.0) return after.phase.rad() - before.phase.rad();
  const std::optional<double> length_m = excess_length_m(after.port);
  if (!length_m) return std::nullopt;
  const double calibrated = std::fmod(after.phase.rad() - phase_of(*length_m, df), kTwoPi);
  return (calibrated < 0.0 ? calibrated + kTwoPi : calibrated) - before.phase.rad();
}

}  // namespace rfmvo
