// The pose of a view as the solvers want it: V to camera, in unscaled lengths.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/rigid.hpp"

namespace rfmvo {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// T_C_V: takes coordinates in V to the camera frame; the translation is in units of V.
struct ViewPose {
  Eigen::Quaterniond R_C_V = Eigen::Quaterniond::Identity();
  Eigen::Vector3d t_C_V = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p_V) const { return R_C_V * p_V + t_C_V; }
  [[nodiscard]] Eigen::Vector3d centre() const { return -(R_C_V.conjugate() * t_C_V); }  // p_V_C
  [[nodiscard]] Eigen::Vector3d to_V(const Eigen::Vector3d& p_C) const { return R_C_V.conjugate() * (p_C - t_C_V); }
};

// The step of every solver here: rotation vector (rad), then translation, both in C, applied from the
// left: p_C' = exp(omega) p_C + v. Rotations are normalised at every step, because un-normalised ones
// doubled the error every frame.
[[nodiscard]] inline ViewPose moved(const ViewPose& T_C_V, const Vector6d& step) {
  const Eigen::Quaterniond R = so3_exp(step.head<3>());
  return {(R * T_C_V.R_C_V).normalized(), R * T_C_V.t_C_V + step.tail<3>()};
}

// T_C2_C1 of two views.
[[nodiscard]] inline ViewPose relative(const ViewPose& T_C2_V, const ViewPose& T_C1_V) {
  const Eigen::Quaterniond R = (T_C2_V.R_C_V * T_C1_V.R_C_V.conjugate()).normalized();
  return {R, T_C2_V.t_C_V - R * T_C1_V.t_C_V};
}

// T_C2_V from T_C2_C1 and T_C1_V.
[[nodiscard]] inline ViewPose composed(const ViewPose& T_C2_C1, const ViewPose& T_C1_V) {
  return {(T_C2_C1.R_C_V * T_C1_V.R_C_V).normalized(), T_C2_C1.R_C_V * T_C1_V.t_C_V + T_C2_C1.t_C_V};
}

[[nodiscard]] inline UnscaledPose to_unscaled(const ViewPose& T_C_V) {
  return {T_C_V.R_C_V.conjugate(), T_C_V.centre()};
}

}  // namespace rfmvo
