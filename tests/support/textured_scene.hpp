// Pictures of textured planes seen by a pinhole camera whose pose is known: truth for the odometry.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "estimator/event.hpp"
#include "geometry/camera_model.hpp"
#include "geometry/rigid.hpp"

namespace rfmvo {

// Random rectangles of random grey, slightly blurred; the seed decides.
[[nodiscard]] cv::Mat texture(int width_px, int height_px, std::uint64_t seed);
// The picture moved by (x, y) pixels, bilinear.
[[nodiscard]] cv::Mat shifted(const cv::Mat& grey, const cv::Point2f& shift_px);

// A rectangle of texture: corner, and the vectors along its width and height, in W (here: metres, the
// camera frame of the first picture).
struct TexturedPlane {
  cv::Mat picture;
  Eigen::Vector3d corner_W, width_W, height_W;
};

// Planes are drawn in order: the far ones first. A camera with distortion gives distorted pictures.
[[nodiscard]] cv::Mat render(const std::vector<TexturedPlane>& planes, const CameraModel& camera, const Rigid3& T_W_C);

// A rolling shutter: every row is seen from where the camera is when it is read; `path` gives T_W_C at a time.
[[nodiscard]] cv::Mat render_rolling(const std::vector<TexturedPlane>& planes, const CameraModel& camera,
                                     const std::function<Rigid3(double)>& path, double time_s, double readout_s);

[[nodiscard]] Frame frame_of(const cv::Mat& grey, double time_s, std::int64_t sequence);

}  // namespace rfmvo
