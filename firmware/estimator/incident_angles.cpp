#include "estimator/incident_angles.hpp"

#include <algorithm>
#include <cmath>

#include "base/assert.hpp"
#include "base/units.hpp"

namespace rfmvo {

Eigen::Vector3d direction_of(const IncidentAngles& a) {
  // Eq. (15)
  return {std::cos(a.alpha_rad) * std::cos(a.beta_rad), std::sin(a.alpha_rad) * std::cos(a.beta_rad),
          std::sin(a.beta_rad)};
}

IncidentAngles angles_of(const Eigen::Vector3d& direction) {
  const double elevation = std::asin(std::clamp(direction.z(), -1.0, 1.0));
  if (direction.y() >= 0.0) return {std::atan2(direction.y(), direction.x()), elevation};
  return {std::atan2(-direction.y(), -direction.x()), kPi - elevation};
}

void AngleSums::add(const IncidentAngles& angles, const Eigen::Quaterniond& R_V_D) {
  alpha_rad_ += angles.alpha_rad;
  beta_rad_ += angles.beta_rad;
  direction_V_ += R_V_D * direction_of(angles);
  ++count_;
}

IncidentAngles AngleSums::mean_angles() const {
  RFMVO_ASSERT(count_ > 0);
  // Eq. (9), (10): the same mean; they differ only in how many arrays exist.
  return {alpha_rad_ / count_, beta_rad_ / count_};
}

Eigen::Vector3d AngleSums::mean_direction_V() const {
  const double length = direction_V_.norm();
  return length > 0.0 ? Eigen::Vector3d(direction_V_ / length) : Eigen::Vector3d::Zero();
}

}  // namespace rfmvo
