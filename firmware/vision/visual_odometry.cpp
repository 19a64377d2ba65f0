#include "vision/visual_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "base/units.hpp"
#include "vision/feature_tracks.hpp"
#include "vision/initialiser.hpp"
#include "vision/map_tracker.hpp"
#include "vision/motion_drift.hpp"

namespace rfmvo {
namespace {

constexpr int kGoodInliers = 30;  // fewer: degraded
constexpr double kGoodInlierShare = 0.6;
constexpr double kGoodSigma = 0.01;  // of the position, over the median depth: above, degraded
constexpr double kHold_s = 0.25;     // without a pose, then a new start is tried, too
// The map is kept as long as most of what it knows may still be in view: 1.5 m at walking speed.
constexpr double kRelocalise_s = 1.5;
constexpr double kGap_s = 0.1;  // since the last pose: a shorter one needs no descriptors
// Until the drift is known, of the pose's covariance against the map, for a key frame; later it was 2 to 10.
constexpr double kFirstDrift = 7.0;
constexpr std::size_t kMinStartTracks = 30;  // fewer after a loss: still lost, there is nothing to start with
constexpr double kRefillShare = 0.7;         // of max_tracks, while starting
constexpr double kCalibratedShare = 0.06;    // of k1_sigma, if the calibration states a distortion: it measured k1
constexpr int kArchiveWindows = 4;           // key frames kept for matching back, in windows

Lens initial_lens(const VisionConfig& config, const CameraModel& camera) {
  const bool calibrated = camera.distortion != Distortion::kRadtan ||
                          std::any_of(camera.radtan.begin(), camera.radtan.end(), [](double k) { return k != 0.0; });
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
  CameraPose stay(DeviceTime time);
  CameraPose without_pose(DeviceTime time);
  void lose();
  void give_up();
  void settle(bool segment_ends);
  [[nodiscard]] Matrix6d motion_covariance(const TrackedPose& pose, double seconds) const;

  Lens lens;  // while there is a tracker, it knows better
  const MapTrackerOptions options;
  Initialiser initialiser;
  std::optional<MapTracker> tracker;  // once there is a map
  bool lost = false;                  // the tracker has not known where it is for a while
  bool was_lost = false;
  std::uint32_t segment = 0;
  std::vector<Track> tracks;  // before there is a map
  Pyramid previous;           // likewise
  std::int64_t next_landmark = 0;
  Matrix6d previous_covariance = Matrix6d::Zero();
  std::vector<SettledPose> settled;  // by the last frame
  std::optional<CameraPose> newest;  // with a pose, of this segment
  bool last_had_pose = false;
  std::shared_ptr<const std::vector<std::uint8_t>> last_image;
};

// Both poses scatter about the map, once over whatever way lies between them, and the map itself drifts. The sum over
// the motions of about a second is to be the covariance of the whole: each has its share of the scatter by time.
Matrix6d VisualOdometry::Impl::motion_covariance(const TrackedPose& pose, double seconds) const {
  const Matrix6d drift = tracker->drift().value_or(kFirstDrift * pose.covariance);
  const double scatter_share = pose.relocalised ? 1.0 : std::clamp(seconds / kDriftHorizon_s, 0.0, 1.0);
  return scatter_share * (pose.covariance + previous_covariance) + pose.keyframe_share * drift;
}

void VisualOdometry::Impl::settle(bool segment_ends) {
  for (SettledPose& pose : tracker->take_settled(segment_ends)) {
    pose.segment = segment;
    settled.push_back(pose);
  }
}

// The map may still be found again; meanwhile another is begun.
void VisualOdometry::Impl::lose() {
  lost = true;
  last_had_pose = false;
  lens = tracker->lens();
  next_landmark = tracker->next_landmark();
  tracks.clear();
  previous.clear();
  initialiser.restart();
}

// The scale dies with the map: what starts after it is another segment.
void VisualOdometry::Impl::give_up() {
  settle(true);
  newest.reset();
  lens = tracker->lens();
  tracker.reset();
  ++segment;
  lost = false;
  was_lost = true;
}

CameraPose VisualOdometry::Impl::without_pose(DeviceTime time) {
  if (tracker) {
    const double since_s = (time - tracker->pose_time()).seconds();
    if (since_s >= kHold_s && !lost) lose();
    if (since_s >= kRelocalise_s) give_up();
  }
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

  if (tracker) give_up();
  initialiser.restart();
  pose.segment = segment;
  for (const auto& [id, landmark] : map->landmarks) pose.inliers += landmark.located;
  pose.T_V_C = to_unscaled(map->keyframes.back().T_C_V);
  pose.status = VoStatus::kTracking;
  previous_covariance.setZero();
  tracker.emplace(options, lens);
  tracker->begin(std::move(*map), std::move(tracks), std::move(pyramid), next_landmark);
  tracks.clear();
  newest = pose;
  last_had_pose = true;
  return pose;
}

// The same bits again: a sensor has noise, so the camera hangs. That is no news about the motion; the pose stays, and
// is not vouched for.
CameraPose VisualOdometry::Impl::stay(DeviceTime time) {
  if (!last_had_pose) return without_pose(time);  // black, for example
  CameraPose pose = *newest;
  pose.time = time;
  pose.status = VoStatus::kDegraded;
  return pose;
}

CameraPose VisualOdometry::Impl::track(DeviceTime time, const Pyramid& pyramid) {
  auto found = lost ? std::nullopt : tracker->on(time, pyramid);
  if (!found && (time - tracker->pose_time()).seconds() > kGap_s) found = tracker->relocalise(time, pyramid);
  last_had_pose = found.has_value();
  if (!found) return lost ? start(time, pyramid) : without_pose(time);
  lost = false;
  CameraPose pose;
  pose.time = time;
  pose.segment = segment;
  pose.status = judge(*found);
  pose.inliers = found->inliers;
  pose.T_V_C = to_unscaled(found->T_C_V);
  pose.motion_covariance = motion_covariance(*found, (time - newest->time).seconds());
  previous_covariance = found->covariance;
  settle(false);
  newest = pose;
  return pose;
}

VisualOdometry::VisualOdometry(const VisionConfig& config, const CameraModel& camera)
    : impl_(std::make_unique<Impl>(config, camera)) {}
VisualOdometry::~VisualOdometry() = default;

const Lens& VisualOdometry::lens() const { return impl_->tracker ? impl_->tracker->lens() : impl_->lens; }

std::span<const SettledPose> VisualOdometry::settled() const { return impl_->settled; }

std::vector<SettledPose> VisualOdometry::finish() {
  impl_->settled.clear();
  if (impl_->tracker) impl_->settle(true);
  return std::move(impl_->settled);
}

OdometryView VisualOdometry::view() const {
  OdometryView view;
  const auto add = [&view](const Track& t, bool located) {
    view.tracks.push_back({t.landmark, {t.px.x, t.px.y}, located, located && t.strikes == 0});
  };
  if (!impl_->tracker) {
    for (const Track& t : impl_->tracks) add(t, false);
    return view;
  }
  const Map& map = impl_->tracker->map();
  for (const Track& t : impl_->tracker->tracks()) {
    const auto it = map.landmarks.find(t.landmark);
    add(t, it != map.landmarks.end() && it->second.located);
  }
  for (const auto& [id, landmark] : map.landmarks) {
    if (landmark.located) view.points_V.push_back(landmark.p_V);
  }
  for (const Keyframe& keyframe : map.keyframes) view.keyframes_V.push_back(keyframe.T_C_V.centre());
  return view;
}

CameraPose VisualOdometry::on(const Frame& frame) {
  impl_->settled.clear();
  const CameraModel& camera = impl_->lens.camera();
  const bool usable =
      frame.grey && frame.width_px == camera.width_px && frame.height_px == camera.height_px &&
      frame.grey->size() == static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  if (!usable) {
    CameraPose pose = impl_->without_pose(frame.time);
    pose.status = VoStatus::kLost;
    return pose;
  }
  const bool again = impl_->last_image && *impl_->last_image == *frame.grey;
  impl_->last_image = frame.grey;
  if (again && impl_->tracker) return impl_->stay(frame.time);
  // OpenCV has no const view of foreign bytes; build_pyramid only reads them.
  const cv::Mat grey(frame.height_px, frame.width_px, CV_8UC1, const_cast<std::uint8_t*>(frame.grey->data()));
  return impl_->tracker ? impl_->track(frame.time, build_pyramid(grey)) : impl_->start(frame.time, build_pyramid(grey));
}

}  // namespace rfmvo
