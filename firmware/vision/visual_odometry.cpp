#include "vision/visual_odometry.hpp"

#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "base/units.hpp"
#include "vision/feature_tracks.hpp"
#include "vision/initialiser.hpp"
#include "vision/map_tracker.hpp"

namespace rfmvo {
namespace {

constexpr int kGoodInliers = 30;  // fewer: degraded
constexpr double kGoodInlierShare = 0.6;
constexpr double kGoodSigma = 0.01;          // of the position, over the median depth: above, degraded
constexpr double kHold_s = 0.25;             // without a pose, then the map is given up ("lost within 0.3 s")
constexpr double kInflation = 2.5;           // of the motion's sigma: the map's own errors are not in it
constexpr std::size_t kMinStartTracks = 30;  // fewer after a loss: still lost, there is nothing to start with
constexpr double kRefillShare = 0.7;         // of max_tracks, while starting
constexpr double kCalibratedShare = 0.06;    // of k1_sigma, if the calibration states a distortion: it measured k1
constexpr int kArchiveWindows = 4;           // key frames kept for matching back, in windows

Lens initial_lens(const VisionConfig& config, const CameraModel& camera) {
  const bool calibrated = std::any_of(camera.radtan.begin(), camera.radtan.end(), [](double k) { return k != 0.0; });
  const double k1_sigma = calibrated ? kCalibratedShare * config.k1_sigma : config.k1_sigma;
  return {camera, {k1_sigma, config.readout_s, config.readout_sigma_s}};
}

MapTrackerOptions tracker_options(const VisionConfig& config, const CameraModel& camera) {
  const auto window = static_cast<int>(config.window_keyframes);
  return {static_cast<int>(config.max_tracks),
          {0.5 * (camera.fx_px + camera.fy_px), config.reprojection_gate_px, rad_from_deg(config.min_parallax_deg),
           window, kArchiveWindows * window}};
}

VoStatus judge(const TrackedPose& pose) {
  const double sigma = std::sqrt(pose.covariance.bottomRightCorner<3, 3>().trace());
  const bool good =
      pose.inliers >= kGoodInliers && pose.inlier_share >= kGoodInlierShare && sigma <= kGoodSigma * pose.median_depth;
  return good ? VoStatus::kTracking : VoStatus::kDegraded;
}

}  // namespace

struct VisualOdometry::Impl {
  Impl(const VisionConfig& config, const CameraModel& camera_model)
      : lens(initial_lens(config, camera_model)),
        options(tracker_options(config, camera_model)),
        initialiser({options.mapping.focal_px, options.mapping.gate_px, options.mapping.min_parallax_rad}) {}

  CameraPose start(DeviceTime time, Pyramid pyramid);
  CameraPose track(DeviceTime time, const Pyramid& pyramid);
  CameraPose without_pose(DeviceTime time);
  void lose();

  Lens lens;  // while there is a tracker, it knows better
  const MapTrackerOptions options;
  Initialiser initialiser;
  std::optional<MapTracker> tracker;  // once there is a map
  bool was_lost = false;
  std::uint32_t segment = 0;
  std::vector<Track> tracks;  // before there is a map
  Pyramid previous;           // likewise
  std::int64_t next_landmark = 0;
  Matrix6d previous_covariance = Matrix6d::Zero();
};

// The scale dies with the map: what starts after it is another segment.
void VisualOdometry::Impl::lose() {
  next_landmark = tracker->next_landmark();
  lens = tracker->lens();
  tracker.reset();
  ++segment;
  was_lost = true;
  tracks.clear();
  previous.clear();
  initialiser.restart();
}

CameraPose VisualOdometry::Impl::without_pose(DeviceTime time) {
  if (tracker && (time - tracker->pose_time()).seconds() >= kHold_s) lose();
  CameraPose pose;
  pose.time = time;
  pose.segment = segment;
  pose.status = tracker || was_lost ? VoStatus::kLost : VoStatus::kInitialising;
  return pose;
}

CameraPose VisualOdometry::Impl::start(DeviceTime time, Pyramid pyramid) {
  std::vector<cv::Point2f> still;
  for (const Track& t : tracks) still.push_back(t.px);
  if (!previous.empty()) tracks = advanced(tracks, previous, pyramid, still, lens.camera());
  if (static_cast<double>(tracks.size()) < kRefillShare * options.max_tracks) {
    refill(tracks, pyramid[0], lens.camera(), options.max_tracks, next_landmark);
  }
  if (tracks.size() >= kMinStartTracks) was_lost = false;
  previous = pyramid;
  CameraPose pose = without_pose(time);
  auto map = initialiser.on(time, pyramid, tracks);
  if (!map) return pose;

  initialiser.restart();
  for (const auto& [id, landmark] : map->landmarks) pose.inliers += landmark.located;
  pose.T_V_C = to_unscaled(map->keyframes.back().T_C_V);
  pose.status = VoStatus::kTracking;
  previous_covariance.setZero();
  tracker.emplace(options, lens);
  tracker->begin(std::move(*map), std::move(tracks), std::move(pyramid), next_landmark);
  tracks.clear();
  return pose;
}

CameraPose VisualOdometry::Impl::track(DeviceTime time, const Pyramid& pyramid) {
  const auto found = tracker->on(time, pyramid);
  if (!found) return without_pose(time);
  CameraPose pose;
  pose.time = time;
  pose.segment = segment;
  pose.status = judge(*found);
  pose.inliers = found->inliers;
  pose.T_V_C = to_unscaled(found->T_C_V);
  // Two poses against the same map, each with its own scatter.
  pose.motion_covariance = kInflation * kInflation * (found->covariance + previous_covariance);
  previous_covariance = found->covariance;
  return pose;
}

VisualOdometry::VisualOdometry(const VisionConfig& config, const CameraModel& camera)
    : impl_(std::make_unique<Impl>(config, camera)) {}
VisualOdometry::~VisualOdometry() = default;

const Lens& VisualOdometry::lens() const { return impl_->tracker ? impl_->tracker->lens() : impl_->lens; }

CameraPose VisualOdometry::on(const Frame& frame) {
  const CameraModel& camera = impl_->lens.camera();
  const bool usable =
      frame.grey && frame.width_px == camera.width_px && frame.height_px == camera.height_px &&
      frame.grey->size() == static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  if (!usable) {
    CameraPose pose = impl_->without_pose(frame.time);
    pose.status = VoStatus::kLost;
    return pose;
  }
  // OpenCV has no const view of foreign bytes; build_pyramid only reads them.
  const cv::Mat grey(frame.height_px, frame.width_px, CV_8UC1, const_cast<std::uint8_t*>(frame.grey->data()));
  return impl_->tracker ? impl_->track(frame.time, build_pyramid(grey)) : impl_->start(frame.time, build_pyramid(grey));
}

}  // namespace rfmvo
