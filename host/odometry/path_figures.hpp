// How good an unscaled path is, against the truth: the figures of `rfmvo vo`.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "estimator/event.hpp"
#include "evaluate/alignment.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::odometry {

// A pose of the path; segments have scales of their own.
struct PathPose {
  DeviceTime time;
  std::uint32_t segment = 0;
  UnscaledPose T_V_C;
  // Of the motion since the pose before, as CameraPose says.
  Eigen::Matrix<double, 6, 6> motion_covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

// Each segment is aligned for itself; errors are the root mean square over all poses of all segments that have at
// least kMinPoses with truth. With one segment ate and rpe are what evo gives (tests/interop).
struct PathFigures {
  int poses = 0;
  double path_m = 0.0;                      // of the truth, over the poses
  double ate_sim3_m = 0.0;                  // evo_ape tum -as
  double ate_se3_m = 0.0;                   // evo_ape tum -a: lengths in units of V taken for metres
  double scale_m_per_unit = 0.0;            // of the longest segment
  double rpe_frame_m = 0.0;                 // evo_rpe tum -as: over one pose
  double rpe_second_m = 0.0;                // evo_rpe tum -as --all_pairs --delta N: over N poses, about 1 s
  double rpe_second_deg = 0.0;              // the same, -r angle_deg
  double step_noise_m = 0.0;                // per axis: steps of 0.1 s, estimated less true, rms / sqrt(3)
  std::optional<double> half_scale_median;  // median |ln(scale of 3 s / scale of the next 3 s)|
  std::optional<double> nees;               // relative pose over 1 s against the sum of its covariances, mean / 6

  [[nodiscard]] double ate_sim3_percent() const { return path_m > 0.0 ? 100.0 * ate_sim3_m / path_m : 0.0; }
};

inline constexpr int kMinPoses = 10;
inline constexpr double kHalfWindow_s = 3.0;  // windows of 6 s, one every kHalfStride_s
inline constexpr double kHalfStride_s = 0.5;
inline constexpr double kMinHalfPath_m = 0.1;  // a half with less way has no scale
inline constexpr double kStep_s = 0.1;

// Nothing if no segment is long enough, or none moves.
[[nodiscard]] std::optional<PathFigures> path_figures(const std::vector<PathPose>& path,
                                                      const std::vector<simulate::TruePose>& truth);

}  // namespace rfmvo::odometry
