#include "vision/optical_flow.hpp"

#include <opencv2/video/tracking.hpp>

namespace rfmvo {
namespace {

constexpr int kWindow_px = 11;  // measured best; 21 was three times worse on a shelf aisle
constexpr int kLevels = 3;      // above the full image: 8 px of error at the top is 64 px
constexpr int kBackLevels = 0;  // the way back starts at the answer it should give
constexpr int kIterations = 15;
constexpr double kStepDone_px = 0.02;
constexpr double kMinEigen = 1e-4;  // OpenCV's default: below, the window has no texture
constexpr float kBackError_px = 0.7F;
constexpr float kMargin_px = 3.0F;

}  // namespace

Pyramid build_pyramid(const cv::Mat& grey) {
  Pyramid pyramid;
  cv::buildOpticalFlowPyramid(grey, pyramid, cv::Size(kWindow_px, kWindow_px), kLevels, true);
  return pyramid;
}

std::vector<Followed> follow(const Pyramid& from, const Pyramid& to, std::span<const cv::Point2f> from_px,
                             std::span<const cv::Point2f> predicted_px) {
  if (from_px.empty()) return {};
  const cv::Size window(kWindow_px, kWindow_px);
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kIterations, kStepDone_px);
  std::vector<cv::Point2f> start(from_px.begin(), from_px.end()), there(predicted_px.begin(), predicted_px.end());
  std::vector<cv::Point2f> back = start;
  std::vector<uchar> found, found_back;
  cv::calcOpticalFlowPyrLK(from, to, start, there, found, cv::noArray(), window, kLevels, criteria,
                           cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigen);
  cv::calcOpticalFlowPyrLK(to, from, there, back, found_back, cv::noArray(), window, kBackLevels, criteria,
                           cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigen);
  const cv::Rect2f inside(kMargin_px, kMargin_px, static_cast<float>(to[0].cols) - 2 * kMargin_px,
                          static_cast<float>(to[0].rows) - 2 * kMargin_px);
  std::vector<Followed> result(start.size());
  for (std::size_t i = 0; i < start.size(); ++i) {
    result[i].at_px = there[i];
    result[i].ok = found[i] != 0 && found_back[i] != 0 && inside.contains(there[i]) &&
                   cv::norm(back[i] - start[i]) < kBackError_px;
  }
  return result;
}

}  // namespace rfmvo
