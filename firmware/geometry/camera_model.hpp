// Pinhole camera with radial-tangential distortion (OpenCV's and Kalibr's "radtan" model).
#pragma once

#include <Eigen/Core>
#include <array>

namespace rfmvo {

struct CameraModel {
  int width_px = 640;
  int height_px = 480;
  double fx_px = 500.0, fy_px = 500.0;
  double cx_px = 319.5, cy_px = 239.5;
  std::array<double, 5> radtan{};  // k1 k2 p1 p2 k3; all zero = an ideal pinhole
};

// Normalised image plane (x/z, y/z) to pixels.
[[nodiscard]] Eigen::Vector2d project(const CameraModel& camera, const Eigen::Vector2d& normalised);
// Derivative of the distortion: of project(), without the focal lengths.
[[nodiscard]] Eigen::Matrix2d distort_jacobian(const CameraModel& camera, const Eigen::Vector2d& normalised);
// Pixels to the normalised image plane; Newton's iteration, error below 1e-9 for |k1| < 0.4.
[[nodiscard]] Eigen::Vector2d unproject(const CameraModel& camera, const Eigen::Vector2d& pixel);

}  // namespace rfmvo
