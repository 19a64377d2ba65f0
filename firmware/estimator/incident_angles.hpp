// Incident angles of a tag at an antenna, and their average over the arrays that share an element:
// Eq. (9), (10), (15). Angles in radians, in the antenna's frame D (antenna_array.hpp).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rfmvo {

struct IncidentAngles {
  double alpha_rad = 0.0;  // azimuth
  double beta_rad = 0.0;   // elevation; [0, pi]^2 covers the hemisphere z >= 0 once, seam at alpha = 0, pi
};

// Eq. (15): unit vector from the antenna to the tag.
[[nodiscard]] Eigen::Vector3d direction_of(const IncidentAngles& angles);

// Inverse of Eq. (15): alpha in [0, pi], beta in [0, pi] where z >= 0 (beyond it where z < 0).
[[nodiscard]] IncidentAngles angles_of(const Eigen::Vector3d& direction);

// Sums over the arrays that contain one element.
class AngleSums {
 public:
  void add(const IncidentAngles& angles, const Eigen::Quaterniond& R_V_D);

  [[nodiscard]] int count() const { return count_; }

  // Eq. (9), (10): the mean of the numbers alpha and beta. Needs count() > 0.
  [[nodiscard]] IncidentAngles mean_angles() const;

  // Differs from Eq. (9), (10): the mean direction on the sphere, because numbers on both sides of the
  // seam average to a direction up to 73 deg away. Unit vector in V; zero if the directions cancel.
  [[nodiscard]] Eigen::Vector3d mean_direction_V() const;

 private:
  double alpha_rad_ = 0.0;
  double beta_rad_ = 0.0;
  Eigen::Vector3d direction_V_ = Eigen::Vector3d::Zero();
  int count_ = 0;
};

}  // namespace rfmvo
