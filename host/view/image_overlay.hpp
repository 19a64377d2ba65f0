// Where tags are in the camera's picture: the position and its 95 % ellipse, projected through the lens.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/camera_model.hpp"
#include "geometry/rigid.hpp"

namespace rfmvo::view {

struct ImageEllipse {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  double major_px = 0.0, minor_px = 0.0;  // half axes of the 95 % ellipse
  double angle_rad = 0.0;                 // of the major one, from x towards y (down)
  double distance_m = 0.0;                // along the optical axis
};

// First order: the covariance through the projection's derivative. Nothing: behind the camera, nearer than 0.1 m, or
// its centre outside of the picture by more than the picture's width.
[[nodiscard]] std::optional<ImageEllipse> in_picture(const CameraModel& camera, const Rigid3& T_W_C,
                                                     const Eigen::Vector3d& p_W_X_m,
                                                     const Eigen::Matrix3d& covariance_W_m2);

}  // namespace rfmvo::view
