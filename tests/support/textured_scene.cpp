#include "support/textured_scene.hpp"

#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>

namespace rfmvo {

cv::Mat texture(int width_px, int height_px, std::uint64_t seed) {
  cv::RNG random(seed * 7919 + 1);
  cv::Mat picture(height_px, width_px, CV_8UC1, cv::Scalar(128));
  const int rectangles = width_px * height_px / 150;  // one for every 12 x 12 px: corners everywhere
  for (int i = 0; i < rectangles; ++i) {
    const cv::Point at(random.uniform(-10, width_px), random.uniform(-10, height_px));
    const cv::Size size(random.uniform(4, 24), random.uniform(4, 24));
    cv::rectangle(picture, cv::Rect(at, size), cv::Scalar(random.uniform(20, 235)), cv::FILLED);
  }
  cv::GaussianBlur(picture, picture, cv::Size(3, 3), 0.7);
  return picture;
}

cv::Mat shifted(const cv::Mat& grey, const cv::Point2f& shift_px) {
  const cv::Matx23d A(1, 0, shift_px.x, 0, 1, shift_px.y);
  cv::Mat out;
  cv::warpAffine(grey, out, A, grey.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  return out;
}

namespace {

cv::Mat render_pinhole(const std::vector<TexturedPlane>& planes, const CameraModel& camera, const Rigid3& T_W_C) {
  cv::Mat image(camera.height_px, camera.width_px, CV_8UC1, cv::Scalar(90));
  const Rigid3 T_C_W = T_W_C.inverse();
  for (const TexturedPlane& plane : planes) {
    // Homography from picture pixels to image pixels: p_C = corner + u width + v height.
    const Eigen::Matrix3d R = T_C_W.R.toRotationMatrix();
    Eigen::Matrix3d H;
    H.col(0) = R * plane.width_W / plane.picture.cols;
    H.col(1) = R * plane.height_W / plane.picture.rows;
    H.col(2) = T_C_W * plane.corner_W;
    Eigen::Matrix3d K;
    K << camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1;
    H = K * H;
    cv::Matx33d h;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) h(i, j) = H(i, j);
    }
    cv::warpPerspective(plane.picture, image, h, image.size(), cv::INTER_AREA, cv::BORDER_TRANSPARENT);
  }
  return image;
}

}  // namespace

cv::Mat render(const std::vector<TexturedPlane>& planes, const CameraModel& camera, const Rigid3& T_W_C) {
  const bool fisheye = camera.distortion == Distortion::kEquidistant;
  if (!fisheye && std::all_of(camera.radtan.begin(), camera.radtan.end(), [](double k) { return k == 0.0; })) {
    return render_pinhole(planes, camera, T_W_C);
  }
  const int kMargin_px = fisheye ? 400 : 40;  // what a barrel lens sees beyond the pinhole's image
  CameraModel wide = camera;
  wide.radtan = {};
  wide.distortion = Distortion::kRadtan;
  wide.width_px += 2 * kMargin_px, wide.height_px += 2 * kMargin_px;
  wide.cx_px += kMargin_px, wide.cy_px += kMargin_px;
  cv::Mat from(camera.height_px, camera.width_px, CV_32FC2), image;
  for (int y = 0; y < from.rows; ++y) {
    for (int x = 0; x < from.cols; ++x) {
      const Eigen::Vector2d px = project(wide, unproject(camera, {x, y}));
      from.at<cv::Vec2f>(y, x) = {static_cast<float>(px.x()), static_cast<float>(px.y())};
    }
  }
  cv::remap(render_pinhole(planes, wide, T_W_C), image, from, cv::noArray(), cv::INTER_CUBIC);
  return image;
}

cv::Mat render_rolling(const std::vector<TexturedPlane>& planes, const CameraModel& camera,
                       const std::function<Rigid3(double)>& path, double time_s, double readout_s) {
  constexpr int kBand_px = 12;  // rows that share a pose
  cv::Mat image(camera.height_px, camera.width_px, CV_8UC1);
  for (int y = 0; y < camera.height_px; y += kBand_px) {
    const cv::Rect rows(0, y, camera.width_px, std::min(kBand_px, camera.height_px - y));
    CameraModel band = camera;
    band.height_px = rows.height;
    band.cy_px -= y;
    const double share = (y + 0.5 * rows.height) / camera.height_px - 0.5;
    render(planes, band, path(time_s + share * readout_s)).copyTo(image(rows));
  }
  return image;
}

Frame frame_of(const cv::Mat& grey, double time_s, std::int64_t sequence) {
  Frame frame;
  frame.time = DeviceTime{Duration::from_seconds(time_s).ns};
  frame.sequence = sequence;
  frame.width_px = grey.cols;
  frame.height_px = grey.rows;
  frame.grey = std::make_shared<const std::vector<std::uint8_t>>(grey.datastart, grey.dataend);
  return frame;
}

}  // namespace rfmvo
