#include "vision/feature_tracks.hpp"

#include "vision/corners.hpp"

namespace rfmvo {
namespace {

constexpr double kWidest = 2.5;  // of the normalised plane, 68 degrees from the axis: beyond, a fisheye lens smears

}  // namespace

std::vector<Track> advanced(std::span<const Track> tracks, const Pyramid& from, const Pyramid& to,
                            std::span<const cv::Point2f> predicted_px, const CameraModel& camera) {
  std::vector<cv::Point2f> from_px;
  for (const Track& t : tracks) from_px.push_back(t.px);
  const std::vector<Followed> flow = follow(from, to, from_px, predicted_px);
  std::vector<Track> result;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!flow[i].ok) continue;
    const cv::Point2f px = flow[i].at_px;
    result.push_back({tracks[i].landmark, px, unproject(camera, {px.x, px.y}), tracks[i].strikes, tracks[i].fresh});
  }
  return result;
}

void refill(std::vector<Track>& tracks, const cv::Mat& grey, const CameraModel& camera, int max_tracks,
            std::int64_t& next_landmark) {
  std::vector<cv::Point2f> occupied;
  for (const Track& t : tracks) occupied.push_back(t.px);
  const int missing = max_tracks - static_cast<int>(tracks.size());
  for (const cv::Point2f& px : find_corners(grey, occupied, max_tracks, missing)) {
    const Eigen::Vector2d normalised = unproject(camera, {px.x, px.y});
    if (normalised.norm() < kWidest) tracks.push_back({next_landmark++, px, normalised});
  }
}

}  // namespace rfmvo
