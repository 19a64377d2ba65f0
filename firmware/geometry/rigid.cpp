#include "geometry/rigid.hpp"

#include <cmath>

namespace rfmvo {

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& omega_rad) {
  const double angle = omega_rad.norm();
  // sin(angle/2)/angle, by its series where the quotient loses digits.
  const double k = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return Eigen::Quaterniond(std::cos(0.5 * angle), k * omega_rad.x(), k * omega_rad.y(), k * omega_rad.z());
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& R) {
  const Eigen::Quaterniond q = R.w() < 0 ? Eigen::Quaterniond(-R.coeffs()) : R;
  const double sine = q.vec().norm();
  if (sine < 1e-9) return 2.0 * q.vec();
  return (2.0 * std::atan2(sine, q.w()) / sine) * q.vec();
}

UnscaledPose interpolate(const UnscaledPose& a, const UnscaledPose& b, double f) {
  const Eigen::Vector3d omega = so3_log(a.R_V_C.conjugate() * b.R_V_C);
  return {(a.R_V_C * so3_exp(f * omega)).normalized(), a.p_V_C + f * (b.p_V_C - a.p_V_C)};
}

Rigid3 interpolate(const Rigid3& a, const Rigid3& b, double f) {
  const Eigen::Vector3d omega = so3_log(a.R.conjugate() * b.R);
  return {(a.R * so3_exp(f * omega)).normalized(), a.t + f * (b.t - a.t)};
}

}  // namespace rfmvo
