// Cramer-Rao bound of a run: no unbiased estimator that knows what these settings say can be better, near the
// truth. Fisher information of the reads with derivatives of the bound's own forward model (read_model.hpp),
// the errors that the simulator really makes (world.hpp), and Gaussian priors for what is known in part. Flips
// and outliers are left out, and so are wrong cycles: what an estimator reaches once it is in the right one.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "bound/world.hpp"

namespace rfmvo::bound {

struct Settings {
  bool known_path = false;           // the true trajectory, in metres
  bool known_lever_arms = false;     // else known to the calibration's own sigma
  bool free_offsets = false;         // an offset per tag and port; else per tag plus per port, shared by all tags
  double time_offset_sigma_s = 0.0;  // of what is known of camera against reader; 0: known
  double length_sigma_m = 10.0;      // of what is known of a port's electrical length
  double knot_spacing_m = 0.15;      // of the odometry's drift
};

// What tells so little is no answer: 1 sigma in the worst direction, and of ln(scale).
inline constexpr double kUnbounded_m = 10.0;
inline constexpr double kUnboundedScale = 1.0;

struct TagBound {
  Epc epc;
  std::size_t reads = 0;
  double distance_m = 0.0;  // from the camera at the closest approach
  // Of the position relative to the camera there, in C. A direction that no read tells anything about has
  // the prior's 100 m.
  Eigen::Matrix3d covariance_C_m2 = Eigen::Matrix3d::Zero();
  std::optional<double> sigma_m;  // root of the trace; nothing: unbounded
};

struct Bound {
  std::vector<TagBound> tags;
  std::size_t unbounded = 0;       // tags without a bound
  std::optional<double> rmse_m;    // root of the mean trace over the bounded tags; nothing: none is
  std::optional<double> median_m;  // of their sigma_m
  // 1 sigma of the Sim(3) scale between recovered and true path; nothing: unbounded, or the path is known.
  std::optional<double> scale_relative;
};

// Clocks count as known unless the run delays the reader: then the delay is unknown, of that size.
[[nodiscard]] Settings settings_for(const simulate::Options& options);

[[nodiscard]] Bound bound_of(const World& world, const Settings& settings);

}  // namespace rfmvo::bound
