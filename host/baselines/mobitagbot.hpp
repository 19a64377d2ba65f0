// MobiTagbot: L. Shangguan, K. Jamieson, "The Design and Implementation of a Mobile RFID Tag Sorting Robot", MobiSys
// 2016: a synthetic aperture over all channels, from which reader locations with multipath are left out.
//
// From there: phase without multipath is linear in the carrier frequency; where the reads of one reader location on
// several channels are not, multipath prevails; these reads are excluded, and the position comes from the hologram of
// the others. The hologram is the plain one, the size of the sum of exp(j residual), per antenna.
// Ours, because the cart does not stop and stays on a channel for 0.2 s only: a location is a stretch of half a
// wavelength of the antenna's way; its phases are corrected for the motion within it by the peak of a first hologram of
// all reads; and since they are already brought to one channel (known_reads.hpp), "linear" is "equal": their RMS about
// the mean direction. More than kMultipath_rad is multipath; but at least half of the reads stay, the best ones.
#pragma once

#include "baselines/hologram.hpp"

namespace rfmvo::baselines {

inline constexpr double kMultipath_rad = 0.3;  // three sigma of the phase noise that Tagoram measured, 0.1 rad
inline constexpr double kLocationLength_m = 0.16;
inline constexpr std::size_t kMinChannels = 3;  // fewer say nothing about a line

class MobiTagbot {
 public:
  explicit MobiTagbot(std::span<const KnownRead> reads);

  [[nodiscard]] double likelihood(const Eigen::Vector3d& p_W_X_m);

 private:
  std::vector<Residuals> antennas_;
  TurnTable phasor_;
};

// Which reads to keep, if the tag is at p: true = no sign of multipath.
[[nodiscard]] std::vector<bool> clear_of_multipath(std::span<const KnownRead> reads, const Eigen::Vector3d& p_W_X_m);

// Needs a read for an answer other than the first cell.
[[nodiscard]] HologramPeak locate_by_mobitagbot(std::span<const KnownRead> reads, const Region& region);

}  // namespace rfmvo::baselines
