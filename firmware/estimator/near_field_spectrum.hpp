// The spatial power spectrum of Eq. (6) for a spherical wave: instead of angles, the position of the
// tag; instead of consecutive differences, one unknown offset per antenna. Global start of the joint
// estimator. docs/estimator.md, section 5.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace rfmvo {

struct SpectrumRead {
  Eigen::Vector3f p_W_A = Eigen::Vector3f::Zero();
  Eigen::Vector3f boresight_W = Eigen::Vector3f::UnitX();
  float turns_per_m = 0.0F;  // 2 f / c
  float phase_turns = 0.0F;
  int group = 0;             // reads of one group share their unknown offset (antenna port)
};

struct SpectrumOptions {
  Eigen::Vector3d cell_m = Eigen::Vector3d::Constant(0.07);  // spacing of the grid along the axes of W
  std::size_t sifting_reads = 24;  // the whole grid is sifted with so many reads, its best cells judged with all
  double range_min_m = 0.25, range_max_m = 5.0;  // from the antenna
  double beam_half_angle_rad = 1.40;             // reads come from the front of an antenna,
  double beam_min_share = 0.9;                   // nearly all of them
  int max_peaks = 12;
};

struct SpectrumPeak {
  Eigen::Vector3d p_W_X = Eigen::Vector3d::Zero();
  // Sum over groups of |sum of unit phasors|^2 / reads: the log-likelihood ratio of "a wave from
  // here" against noise, up to the noise's concentration. At most the number of reads.
  double power = 0.0;
  double cells = 0.0;  // that were searched, the same for all peaks of one search
};

// The spacing that loses at most a radian at the ends of the aperture, per axis: fine along the
// aperture, coarse in range. Between finest_m and widest_m.
[[nodiscard]] Eigen::Vector3d suitable_cell(std::span<const SpectrumRead> reads, double finest_m, double widest_m);

// Peaks of the spectrum, strongest first, at least 1.5 cells apart. Empty if no cell is in the beam.
[[nodiscard]] std::vector<SpectrumPeak> search_near_field(std::span<const SpectrumRead> reads,
                                                          const SpectrumOptions& options);

// The definition at one point (double precision).
[[nodiscard]] double near_field_power(std::span<const SpectrumRead> reads, const Eigen::Vector3d& p_W_X);

}  // namespace rfmvo
