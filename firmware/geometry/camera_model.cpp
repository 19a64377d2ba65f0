#include "geometry/camera_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

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

constexpr double kAxis = 1e-8;  // nearer to the axis the fisheye's formulas divide by nothing

// Distorted radius of a ray at this angle from the axis, and its derivative.
struct FisheyeRadius {
  double radius, slope;
};
FisheyeRadius fisheye_radius(const std::array<double, 4>& k, double angle) {
  const double a = angle * angle;
  return {angle * (1.0 + a * (k[0] + a * (k[1] + a * (k[2] + a * k[3])))),
          1.0 + a * (3.0 * k[0] + a * (5.0 * k[1] + a * (7.0 * k[2] + a * 9.0 * k[3])))};
}

Eigen::Vector2d undistort_fisheye(const std::array<double, 4>& k, const Eigen::Vector2d& d) {
  const double radius = d.norm();
  if (radius < kAxis) return d;
  double angle = std::min(radius, kWidestAngle_rad);
  constexpr int kMaxIterations = 20;
  for (int i = 0; i < kMaxIterations; ++i) {
    const FisheyeRadius f = fisheye_radius(k, angle);
    if (!(f.slope > 0.0)) break;  // the polynomial folds over: such a lens does not exist
    const double correction = (radius - f.radius) / f.slope;
    angle = std::clamp(angle + correction, 0.0, kWidestAngle_rad);
    if (std::abs(correction) < 1e-12) break;
  }
  return d * (std::tan(angle) / radius);
}

Eigen::Vector2d distort(const CameraModel& camera, const Eigen::Vector2d& p) {
  if (camera.distortion == Distortion::kRadtan) return distort(camera.radtan, p);
  const double r = p.norm();
  return r < kAxis ? p : Eigen::Vector2d(p * (fisheye_radius(camera.equidistant, std::atan(r)).radius / r));
}

}  // namespace

Eigen::Vector2d project(const CameraModel& camera, const Eigen::Vector2d& normalised) {
  const Eigen::Vector2d d = distort(camera, normalised);
  return {camera.fx_px * d.x() + camera.cx_px, camera.fy_px * d.y() + camera.cy_px};
}

Eigen::Matrix2d distort_jacobian(const CameraModel& camera, const Eigen::Vector2d& normalised) {
  if (camera.distortion == Distortion::kRadtan) return distort_jacobian(camera.radtan, normalised);
  const double r = normalised.norm();
  if (r < kAxis) return Eigen::Matrix2d::Identity();
  const FisheyeRadius f = fisheye_radius(camera.equidistant, std::atan(r));
  const double across = f.radius / r, along = f.slope / (1.0 + r * r);
  const Eigen::Vector2d e = normalised / r;
  return across * Eigen::Matrix2d::Identity() + (along - across) * e * e.transpose();
}

Eigen::Vector2d distort_d_k1(const CameraModel& camera, const Eigen::Vector2d& normalised) {
  const double r = normalised.norm();
  if (camera.distortion == Distortion::kRadtan || r < kAxis) return normalised * (r * r);
  return normalised * (std::pow(std::atan(r), 3) / r);
}

Eigen::Vector2d unproject(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d distorted((pixel.x() - camera.cx_px) / camera.fx_px, (pixel.y() - camera.cy_px) / camera.fy_px);
  if (camera.distortion == Distortion::kEquidistant) return undistort_fisheye(camera.equidistant, distorted);
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

double image_scale(const CameraModel& camera, const Eigen::Vector2d& normalised) {
  if (camera.distortion == Distortion::kRadtan) return 1.0;
  return std::sqrt(std::abs(distort_jacobian(camera, normalised).determinant()));
}

double k1_of(const CameraModel& camera) {
  return camera.distortion == Distortion::kRadtan ? camera.radtan[0] : camera.equidistant[0];
}

void set_k1(CameraModel& camera, double k1) {
  (camera.distortion == Distortion::kRadtan ? camera.radtan[0] : camera.equidistant[0]) = k1;
}

}  // namespace rfmvo
