// How wrong a phase is, and how alike two errors are. Real reads (DESIGN 2.7): a smooth, structured
// error (multipath, antenna pattern) of 0.2..0.8 rad that decorrelates over 8..10 cm of antenna
// travel, plus white noise by RSSI, plus rare pi flips of the reader. docs/estimator.md, section 2.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace rfmvo {

// Matern 3/2 correlation (1 + a) exp(-a), a = distance / length. With length 5.8 cm it runs through
// the measured 0.94/0.85/0.61/0.37/0.16 at 2/4/8/12/16 cm within 0.08; exp(-distance/length), the
// whitener of first thought, is 0.15 too low at 2 cm.
[[nodiscard]] double matern32(double distance_m, double length_m);

// How the structured errors of a site go: alike over this length, and stronger where the direct path is weak
// against its echoes: in proportion to (field strength against the tag's strong reads)^-fade_exponent. In an aisle of
// image sources 0.27 rad on boresight grow to 0.8 where the beam has lost 30 dB; 0 is an error of one strength.
struct StructuredShape {
  double length_m = 0.058;
  double fade_exponent = 0.0;
  double long_share = 0.0;  // of the variance: alike over kLongLength_m (echoes from large, near surfaces)
};
inline constexpr double kLongLength_m = 0.2;

// Correlation of the structured errors of two reads whose antennas were this far apart.
[[nodiscard]] double structured_correlation(double distance_m, const StructuredShape& shape);

// Strength of a read's structured error against that of the tag's strong reads. fade_db: how much less power.
[[nodiscard]] double relative_strength(double fade_db, const StructuredShape& shape);

// 1 sigma of the reader's own noise: 0.022 rad above -45 dBm, 0.06 at -55..-45, 0.2 below (real
// R420 data), interpolated in dB so that no read falls off a cliff.
[[nodiscard]] double white_sigma_rad(double rssi_dbm);

// Conditioning of one error on the few before it in its (tag, port) chain (Vecchia's approximation:
// exact for a Markov error, constant work per read).
struct Conditioning {
  static constexpr std::size_t kMaxNeighbours = 3;
  std::array<double, kMaxNeighbours> weights{};
  double variance_rad2 = 1.0;  // of the error given the neighbours
};

// correlation(i, j) of the structured errors of samples 0..count (0 = this read, 1..count its neighbours), in units
// of structured_sigma_rad^2, white_rad2 alike.
[[nodiscard]] Conditioning condition_on_correlated(std::size_t count, const Eigen::Matrix<double, 4, 4>& correlation,
                                                   const Eigen::Vector4d& white_rad2, double structured_sigma_rad);

// distances_m(i, j) between samples 0..count (0 = this read, 1..count its neighbours), white_rad2 alike.
[[nodiscard]] Conditioning condition_on_neighbours(std::size_t count, const Eigen::Matrix<double, 4, 4>& distances_m,
                                                   const Eigen::Vector4d& white_rad2, double structured_sigma_rad,
                                                   double length_m);

}  // namespace rfmvo
