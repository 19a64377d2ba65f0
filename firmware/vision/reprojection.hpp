// Reprojection error on the undistorted image and its derivatives.
#pragma once

#include <Eigen/Core>

#include "vision/view_pose.hpp"

namespace rfmvo {

// Points nearer than this (units of V; the scene is about 1 away at the start) count as behind the camera.
inline constexpr double kMinDepth = 0.01;

struct Reprojection {
  bool in_front = false;
  Eigen::Vector2d error_px = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 3> d_camera_point = Eigen::Matrix<double, 2, 3>::Zero();  // d error / d p_C
};

// error = focal * (p_C.xy / p_C.z - measured), measured on the normalised image plane.
[[nodiscard]] inline Reprojection reproject(const Eigen::Vector3d& p_C, const Eigen::Vector2d& measured,
                                            double focal_px) {
  Reprojection r;
  if (!(p_C.z() > kMinDepth)) return r;
  r.in_front = true;
  const double inverse_z = 1.0 / p_C.z();
  const double u = p_C.x() * inverse_z, v = p_C.y() * inverse_z;
  r.error_px = focal_px * Eigen::Vector2d(u - measured.x(), v - measured.y());
  const double k = focal_px * inverse_z;
  r.d_camera_point << k, 0.0, -k * u, 0.0, k, -k * v;
  return r;
}

// d error / d step of moved(): d p_C / d omega = -skew(p_C), d p_C / d v = I.
[[nodiscard]] inline Eigen::Matrix<double, 2, 6> d_pose(const Reprojection& r, const Eigen::Vector3d& p_C) {
  Eigen::Matrix<double, 2, 6> J;
  J.leftCols<3>() = -r.d_camera_point * skew(p_C);
  J.rightCols<3>() = r.d_camera_point;
  return J;
}

// Huber: quadratic up to k, then linear. The weight is d cost / d (error^2).
[[nodiscard]] inline double huber_weight(double error_px, double k_px) {
  return error_px <= k_px ? 1.0 : k_px / error_px;
}
[[nodiscard]] inline double huber_cost(double error_px, double k_px) {
  return error_px <= k_px ? error_px * error_px : k_px * (2.0 * error_px - k_px);
}

}  // namespace rfmvo
