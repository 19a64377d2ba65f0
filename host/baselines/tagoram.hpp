// Tagoram's differential augmented hologram: L. Yang et al., "Tagoram: Real-Time Tracking of Mobile RFID Tags to High
// Precision Using COTS Devices", MobiCom 2014, the controllable case (known track), seen from the tag: the antennas
// move, as RF-MVO section VII.C says.
//
// From there: phase differences against the first read of each antenna, which cancel the unknown constant of tag and
// antenna; each as a phasor exp(j delta) weighted with the probability that Gaussian phase noise of 0.1 rad (0.1 sqrt 2
// of a difference) is off by |delta| or more; the size of the sum over antennas and reads is the likelihood of a cell:
//   L(x) = | sum_m sum_{n >= 2} 2 (1 - F(|delta_mn|; 0, 0.1 sqrt 2)) exp(j delta_mn) |,
//   delta_mn = (theta_mn - theta_m1) - (4 pi / lambda) (d_mn(x) - d_m1(x)), wrapped to [-pi, pi].
// Ours: phases of all channels are brought to one before (known_reads.hpp).
#pragma once

#include "baselines/hologram.hpp"

namespace rfmvo::baselines {

inline constexpr double kTagoramPhaseSigma_rad = 0.1;

class Tagoram {
 public:
  explicit Tagoram(std::span<const KnownRead> reads);

  [[nodiscard]] double likelihood(const Eigen::Vector3d& p_W_X_m);

 private:
  std::vector<Residuals> antennas_;  // of two reads at least
  TurnTable phasor_;
};

// Needs two reads of one group for an answer other than the first cell.
[[nodiscard]] HologramPeak locate_by_tagoram(std::span<const KnownRead> reads, const Region& region);

}  // namespace rfmvo::baselines
