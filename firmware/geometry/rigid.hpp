// Rigid motions. T_A_B takes coordinates in frame B to frame A: p_A = T_A_B * p_B; adjacent letters
// cancel. Frames: W metric world (REP-103 at the start: x forward, y left, z up), B body/cart
// (REP-103), C camera (optical: x right, y down, z forward), V unscaled visual-odometry world (the
// camera frame of a segment's first pose), A1.. antennas (z boresight), X tag.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rfmvo {

// Metric rigid motion; translation in metres.
struct Rigid3 {
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  [[nodiscard]] Rigid3 inverse() const { return {R.conjugate(), -(R.conjugate() * t)}; }
  friend Rigid3 operator*(const Rigid3& a, const Rigid3& b) { return {(a.R * b.R).normalized(), a.t + a.R * b.t}; }
  friend Eigen::Vector3d operator*(const Rigid3& a, const Eigen::Vector3d& p) { return a.t + a.R * p; }
};

// Camera pose in the unscaled world V: the translation has NO metric unit; only a scale factor
// (metres per unit of V) may turn it into metres. Hence a type of its own.
struct UnscaledPose {
  Eigen::Quaterniond R_V_C = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_V_C = Eigen::Vector3d::Zero();
};

[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);               // skew(a) b = a x b
[[nodiscard]] Eigen::Quaterniond so3_exp(const Eigen::Vector3d& omega_rad);  // rotation vector to rotation
[[nodiscard]] Eigen::Vector3d so3_log(const Eigen::Quaterniond& R);          // inverse; |result| <= pi

// Interpolation at fraction f in [0, 1]: rotation along the geodesic (constant angular velocity),
// translation linear (constant world velocity). Extrapolates for f outside.
[[nodiscard]] UnscaledPose interpolate(const UnscaledPose& a, const UnscaledPose& b, double f);
[[nodiscard]] Rigid3 interpolate(const Rigid3& a, const Rigid3& b, double f);

}  // namespace rfmvo
