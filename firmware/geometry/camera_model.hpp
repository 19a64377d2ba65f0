// Cameras: a pinhole with radial-tangential distortion (OpenCV's and Kalibr's "radtan"), or a fisheye lens whose image
// radius follows the angle (Kalibr's "equidistant", OpenCV's fisheye module; Kannala and Brandt, IEEE PAMI 28(8), 2006).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace rfmvo {

enum class Distortion : std::uint8_t { kRadtan = 0, kEquidistant = 1 };

struct CameraModel {
  int width_px = 640;
  int height_px = 480;
  double fx_px = 500.0, fy_px = 500.0;
  double cx_px = 319.5, cy_px = 239.5;
  std::array<double, 5> radtan{};  // k1 k2 p1 p2 k3; all zero = an ideal pinhole
  Distortion distortion = Distortion::kRadtan;
  std::array<double, 4> equidistant{};  // k1 k2 k3 k4; used instead of radtan if the distortion says so
};

// Normalised image plane (x/z, y/z) to pixels.
[[nodiscard]] Eigen::Vector2d project(const CameraModel& camera, const Eigen::Vector2d& normalised);
// Derivative of the distortion: of project(), without the focal lengths.
[[nodiscard]] Eigen::Matrix2d distort_jacobian(const CameraModel& camera, const Eigen::Vector2d& normalised);
// Derivative of the distortion with respect to k1.
[[nodiscard]] Eigen::Vector2d distort_d_k1(const CameraModel& camera, const Eigen::Vector2d& normalised);
// Pixels to the normalised image plane; Newton's iteration, error below 1e-9 for |k1| < 0.4. Of a fisheye lens, what
// lies beyond kWidestAngle_rad from the axis is taken to be there.
[[nodiscard]] Eigen::Vector2d unproject(const CameraModel& camera, const Eigen::Vector2d& pixel);

// How much larger the image is here than in the middle: the normalised plane stretches what a fisheye lens sees aside.
// 1 for radtan, whose stretching is small.
[[nodiscard]] double image_scale(const CameraModel& camera, const Eigen::Vector2d& normalised);

[[nodiscard]] double k1_of(const CameraModel& camera);
void set_k1(CameraModel& camera, double k1);

inline constexpr double kWidestAngle_rad = 1.4;  // 80 degrees: 5.8 on the normalised plane

}  // namespace rfmvo
