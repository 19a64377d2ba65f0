#include "baselines/tagoram.hpp"

#include <cmath>

namespace rfmvo::baselines {
namespace {

// 2 (1 - F(|delta|)) = erfc(|delta| / (sigma sqrt 2)), sigma = 0.1 sqrt 2.
std::complex<double> weighted_phasor(double delta_rad) {
  return std::polar(std::erfc(std::abs(delta_rad) / (2.0 * kTagoramPhaseSigma_rad)), delta_rad);
}

}  // namespace

Tagoram::Tagoram(std::span<const KnownRead> reads) : phasor_(weighted_phasor) {
  for (const auto& group : by_group(reads))
    if (group.size() >= 2) antennas_.emplace_back(group);
}

double Tagoram::likelihood(const Eigen::Vector3d& p_W_X_m) {
  std::complex<float> sum;
  for (Residuals& antenna : antennas_) {
    const Eigen::ArrayXf& turns = antenna.at(p_W_X_m);
    for (Eigen::Index n = 1; n < turns.size(); ++n) sum += phasor_(turns(n) - turns(0));
  }
  return std::abs(sum);
}

HologramPeak locate_by_tagoram(std::span<const KnownRead> reads, const Region& region) {
  Tagoram tagoram(reads);
  return likeliest_cell(region, [&](const Eigen::Vector3d& p) { return tagoram.likelihood(p); });
}

}  // namespace rfmvo::baselines
