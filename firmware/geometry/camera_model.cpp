#include "geometry/camera_model.hpp"

#include <Eigen/LU>

namespace rfmvo {
namespace {

// OpenCV 4.6 documentation, "Camera Calibration and 3D Reconstruction": x'' and y'' of radtan.
Eigen::Vector2d distort(const std::array<double, 5>& k, const Eigen::Vector2d& p) {
  const double r2 = p.squaredNorm();
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  return {p.x() * radial + 2.0 * k[2] * p.x() * p.y() + k[3] * (r2 + 2.0 * p.x() * p.x()),
          p.y() * radial + k[2] * (r2 + 2.0 * p.y() * p.y()) + 2.0 * k[3] * p.x() * p.y()};
}

// Derivative of distort().
Eigen::Matrix2d distort_jacobian(const std::array<double, 5>& k, const Eigen::Vector2d& p) {
  const double r2 = p.squaredNorm();
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double slope = 2.0 * (k[0] + r2 * (2.0 * k[1] + 3.0 * r2 * k[4]));  // d radial / d p = slope * p
  Eigen::Matrix2d J = radial * Eigen::Matrix2d::Identity() + slope * p * p.transpose();
  J(0, 0) += 2.0 * k[2] * p.y() + 6.0 * k[3] * p.x();
  J(0, 1) += 2.0 * k[2] * p.x() + 2.0 * k[3] * p.y();
  J(1, 0) += 2.0 * k[2] * p.x() + 2.0 * k[3] * p.y();
  J(1, 1) += 6.0 * k[2] * p.y() + 2.0 * k[3] * p.x();
  return J;
}

}  // namespace

Eigen::Vector2d project(const CameraModel& camera, const Eigen::Vector2d& normalised) {
  const Eigen::Vector2d d = distort(camera.radtan, normalised);
  return {camera.fx_px * d.x() + camera.cx_px, camera.fy_px * d.y() + camera.cy_px};
}

Eigen::Matrix2d distort_jacobian(const CameraModel& camera, const Eigen::Vector2d& normalised) {
  return distort_jacobian(camera.radtan, normalised);
}

Eigen::Vector2d unproject(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d distorted((pixel.x() - camera.cx_px) / camera.fx_px, (pixel.y() - camera.cy_px) / camera.fy_px);
  Eigen::Vector2d p = distorted;
  constexpr int kMaxIterations = 20;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Eigen::Vector2d correction =
        distort_jacobian(camera.radtan, p).partialPivLu().solve(distorted - distort(camera.radtan, p));
    p += correction;
    if (correction.squaredNorm() < 1e-24) break;
  }
  return p;
}

}  // namespace rfmvo
