#include "vision/visual_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>

#include "base/units.hpp"
#include "vision/corners.hpp"
#include "vision/initialiser.hpp"
#include "vision/mapping.hpp"
#include "vision/motion_solver.hpp"

namespace rfmvo {
namespace {

constexpr double kKeyframeFlow_rad = 20.0 / 520.0;  // VISION design: rotation-compensated, 20 px at f about 520 px
constexpr double kKeyframeCommon = 0.7;             // VISION design: of the last key frame's tracks
constexpr int kMinInliers = 12;                     // fewer: no pose
constexpr int kGoodInliers = 30;                    // fewer: degraded
constexpr double kMinInlierShare = 0.4;             // of the located tracks: below, no pose
constexpr double kGoodInlierShare = 0.6;
constexpr int kMaxStrikes = 3;                      // frames above the gate before a track is dropped
constexpr double kHold_s = 0.25;                    // without a pose: the map is given up ("lost within 0.3 s")
constexpr double kInflation = 2.5;                  // of the motion's sigma: the map's own errors are not in it
constexpr std::size_t kMinStartTracks = 30;

}  // namespace

struct VisualOdometry::Impl {
  Impl(const VisionConfig& c, const CameraModel& m)
      : config(c),
        camera(m),
        focal_px(0.5 * (m.fx_px + m.fy_px)),
        initialiser({focal_px, c.reprojection_gate_px, rad_from_deg(c.min_parallax_deg)}),
        mapping{focal_px, c.reprojection_gate_px, rad_from_deg(c.min_parallax_deg),
                static_cast<int>(c.window_keyframes), static_cast<int>(4 * c.window_keyframes)} {}

  CameraPose on(const Frame& frame);
  CameraPose start(DeviceTime time, Pyramid pyramid);
  CameraPose track(DeviceTime time, Pyramid pyramid);
  CameraPose without_pose(DeviceTime time);
  void restart();

  void advance(const Pyramid& pyramid, const std::vector<cv::Point2f>& predicted, std::vector<Track>& moved_tracks) const;
  [[nodiscard]] std::vector<cv::Point2f> predict(const ViewPose& T_C_V) const;
  [[nodiscard]] MotionSolution locate_camera(const ViewPose& predicted, std::vector<Track>& followed) const;
  [[nodiscard]] bool wants_keyframe() const;
  void add_keyframe(DeviceTime time, const Pyramid& pyramid);
  void refill(const Pyramid& pyramid);
  [[nodiscard]] cv::Point2f to_pixel(const Eigen::Vector2d& normalised) const {
    const Eigen::Vector2d px = project(camera, normalised);
    return {static_cast<float>(px.x()), static_cast<float>(px.y())};
  }

  const VisionConfig config;
  const CameraModel camera;
  const double focal_px;
  Initialiser initialiser;
  const MappingOptions mapping;

  bool has_map = false;
  bool was_lost = false;
  std::uint32_t segment = 0;
  std::int64_t next_landmark = 0;
  Map map;
  std::vector<Track> tracks;  // sorted by landmark; where they are in `previous`
  Pyramid previous;
  DeviceTime previous_time;
  DeviceTime pose_time;  // of the newest pose
  ViewPose T_C_V;        // the newest pose
  ViewPose motion;       // T_C2_C1 of the two newest poses
  double motion_s = 0.0;
  double median_depth = 1.0;
  Matrix6d previous_covariance = Matrix6d::Zero();
  std::size_t keyframe_tracks = 0;
};

void VisualOdometry::Impl::restart() {
  if (has_map) ++segment;
  has_map = false;
  was_lost = true;
  map = {};
  tracks.clear();
  previous.clear();
  initialiser.restart();
}

CameraPose VisualOdometry::Impl::without_pose(DeviceTime time) {
  CameraPose pose;
  pose.time = time;
  pose.segment = segment;
  pose.status = has_map || was_lost ? VoStatus::kLost : VoStatus::kInitialising;
  return pose;
}

void VisualOdometry::Impl::advance(const Pyramid& pyramid, const std::vector<cv::Point2f>& predicted,
                                   std::vector<Track>& followed) const {
  std::vector<cv::Point2f> from;
  for (const Track& t : tracks) from.push_back(t.px);
  const std::vector<Followed> flow = follow(previous, pyramid, from, predicted);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!flow[i].ok) continue;
    Track t = tracks[i];
    t.px = flow[i].at_px;
    t.normalised = unproject(camera, {t.px.x, t.px.y});
    followed.push_back(t);
  }
}

void VisualOdometry::Impl::refill(const Pyramid& pyramid) {
  std::vector<cv::Point2f> occupied;
  for (const Track& t : tracks) occupied.push_back(t.px);
  const int most = static_cast<int>(config.max_tracks);
  for (const cv::Point2f& px : find_corners(pyramid[0], occupied, most, most - static_cast<int>(tracks.size()))) {
    tracks.push_back({next_landmark++, px, unproject(camera, {px.x, px.y}), 0});
  }
}

CameraPose VisualOdometry::Impl::start(DeviceTime time, Pyramid pyramid) {
  if (!previous.empty()) {
    std::vector<cv::Point2f> still;
    for (const Track& t : tracks) still.push_back(t.px);
    std::vector<Track> followed;
    advance(pyramid, still, followed);
    tracks = std::move(followed);
  }
  if (tracks.size() < 0.7 * static_cast<double>(config.max_tracks)) refill(pyramid);
  previous = pyramid;
  previous_time = time;
  if (tracks.size() >= kMinStartTracks) was_lost = false;
  CameraPose pose = without_pose(time);
  auto first_map = initialiser.on(time, pyramid, tracks);
  if (!first_map) return pose;
  map = std::move(*first_map);
  initialiser.restart();
  has_map = true;
  T_C_V = ViewPose{};
  const Keyframe& before = map.keyframes[map.keyframes.size() - 2];
  motion = relative(T_C_V, before.T_C_V);
  motion_s = (time - before.time).seconds();
  pose_time = time;
  median_depth = 1.0;
  for (const auto& [id, landmark] : map.landmarks) pose.inliers += landmark.located;
  refill(pyramid);
  for (const Track& t : tracks) {
    Landmark& landmark = map.landmarks[t.landmark];
    if (landmark.observations.empty()) landmark.observations.push_back({map.keyframes.back().id, t.px, t.normalised});
  }
  keyframe_tracks = tracks.size();
  pose.status = VoStatus::kTracking;
  pose.T_V_C = to_unscaled(T_C_V);
  return pose;
}

std::vector<cv::Point2f> VisualOdometry::Impl::predict(const ViewPose& predicted) const {
  std::vector<cv::Point2f> px;
  for (const Track& t : tracks) {
    const auto it = map.landmarks.find(t.landmark);
    const bool located = it != map.landmarks.end() && it->second.located;
    const Eigen::Vector3d p_V = located ? it->second.p_V : T_C_V.to_V(median_depth * t.normalised.homogeneous());
    const Eigen::Vector3d p_C = predicted * p_V;
    px.push_back(p_C.z() > 0.1 * median_depth ? to_pixel(p_C.hnormalized()) : t.px);
  }
  return px;
}

MotionSolution VisualOdometry::Impl::locate_camera(const ViewPose& predicted, std::vector<Track>& followed) const {
  std::vector<MotionObservation> seen;
  std::vector<std::size_t> track_of;
  for (std::size_t i = 0; i < followed.size(); ++i) {
    const auto it = map.landmarks.find(followed[i].landmark);
    if (it == map.landmarks.end() || !it->second.located) continue;
    seen.push_back({it->second.p_V, followed[i].normalised});
    track_of.push_back(i);
  }
  const MotionOptions options{focal_px, 0.6, config.reprojection_gate_px};
  MotionSolution s = solve_motion(seen, predicted, options);
  const auto enough = [&seen](const MotionSolution& m) {
    return m.inliers >= kMinInliers && m.inliers >= kMinInlierShare * static_cast<double>(seen.size());
  };
  if (!enough(s)) {
    MotionSolution global = solve_motion_globally(seen, predicted, options);
    if (global.inliers > s.inliers) s = std::move(global);
  }
  if (!enough(s)) s.inliers = 0;
  for (std::size_t k = 0; k < track_of.size(); ++k) {
    int& strikes = followed[track_of[k]].strikes;
    strikes = s.error_px[k] <= options.gate_px ? 0 : strikes + 1;
  }
  return s;
}

bool VisualOdometry::Impl::wants_keyframe() const {
  const Keyframe& last = map.keyframes.back();
  const Eigen::Quaterniond R = T_C_V.R_C_V * last.T_C_V.R_C_V.conjugate();
  std::vector<double> flows;
  std::size_t shared = 0;
  for (const Track& t : tracks) {
    const auto it = map.landmarks.find(t.landmark);
    if (it == map.landmarks.end() || it->second.observations.empty()) continue;
    const KeyframeObservation& o = it->second.observations.back();
    if (o.keyframe != last.id) continue;
    ++shared;
    flows.push_back((t.normalised - (R * o.normalised.homogeneous()).hnormalized()).norm());
  }
  if (static_cast<double>(shared) < kKeyframeCommon * static_cast<double>(keyframe_tracks)) return true;
  const auto middle = flows.begin() + static_cast<std::ptrdiff_t>(flows.size() / 2);
  std::nth_element(flows.begin(), middle, flows.end());
  return *middle > kKeyframeFlow_rad;
}

void VisualOdometry::Impl::add_keyframe(DeviceTime time, const Pyramid& pyramid) {
  const std::int64_t id = map.keyframes.back().id + 1;
  map.keyframes.push_back({id, time, T_C_V, pyramid});
  for (const Track& t : tracks) {
    if (t.strikes == 0) map.landmarks[t.landmark].observations.push_back({id, t.px, t.normalised});
  }
  adjust_window(map, mapping);
  T_C_V = map.keyframes.back().T_C_V;
  refill(pyramid);
  for (const Track& t : tracks) {
    Landmark& landmark = map.landmarks[t.landmark];
    if (landmark.observations.empty()) landmark.observations.push_back({id, t.px, t.normalised});
  }
  forget_old(map, tracks, mapping);
  keyframe_tracks = tracks.size();
}

CameraPose VisualOdometry::Impl::track(DeviceTime time, Pyramid pyramid) {
  const double dt = (time - pose_time).seconds();
  const double ratio = motion_s > 0.0 ? std::clamp(dt / motion_s, 0.0, 3.0) : 0.0;
  const ViewPose step{so3_exp(ratio * so3_log(motion.R_C_V)), ratio * motion.t_C_V};
  const ViewPose predicted = composed(step, T_C_V);
  std::vector<Track> followed;
  advance(pyramid, predict(predicted), followed);
  const MotionSolution s = locate_camera(predicted, followed);
  if (s.inliers == 0) {
    if (dt >= kHold_s) restart();
    return without_pose(time);
  }
  motion = relative(s.T_C_V, T_C_V);
  motion_s = dt;
  T_C_V = s.T_C_V;
  pose_time = previous_time = time;
  tracks = std::move(followed);
  std::erase_if(tracks, [](const Track& t) { return t.strikes >= kMaxStrikes; });
  locate_landmarks(map, tracks, T_C_V, mapping);
  std::size_t located = 0;
  std::vector<double> depths;
  for (const Track& t : tracks) {
    const Landmark& landmark = map.landmarks[t.landmark];
    if (!landmark.located) continue;
    ++located;
    depths.push_back((T_C_V * landmark.p_V).z());
  }
  std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2), depths.end());
  median_depth = depths[depths.size() / 2];
  if (wants_keyframe()) add_keyframe(time, pyramid);
  previous = std::move(pyramid);

  CameraPose pose;
  pose.time = time;
  pose.segment = segment;
  pose.inliers = s.inliers;
  const bool good = s.inliers >= kGoodInliers && s.inliers >= kGoodInlierShare * static_cast<double>(s.error_px.size());
  pose.status = good ? VoStatus::kTracking : VoStatus::kDegraded;
  pose.T_V_C = to_unscaled(T_C_V);
  pose.motion_covariance = kInflation * kInflation * (s.covariance + previous_covariance);
  previous_covariance = s.covariance;
  return pose;
}

CameraPose VisualOdometry::Impl::on(const Frame& frame) {
  const bool usable = frame.grey && frame.width_px == camera.width_px && frame.height_px == camera.height_px &&
                      frame.grey->size() == static_cast<std::size_t>(frame.width_px) * static_cast<std::size_t>(frame.height_px);
  if (!usable) {
    if (has_map && (frame.time - pose_time).seconds() >= kHold_s) restart();
    CameraPose pose = without_pose(frame.time);
    pose.status = VoStatus::kLost;
    return pose;
  }
  // OpenCV has no const view of foreign bytes; build_pyramid only reads them.
  const cv::Mat grey(frame.height_px, frame.width_px, CV_8UC1, const_cast<std::uint8_t*>(frame.grey->data()));
  return has_map ? track(frame.time, build_pyramid(grey)) : start(frame.time, build_pyramid(grey));
}

VisualOdometry::VisualOdometry(const VisionConfig& config, const CameraModel& camera)
    : impl_(std::make_unique<Impl>(config, camera)) {}
VisualOdometry::~VisualOdometry() = default;
CameraPose VisualOdometry::on(const Frame& frame) { return impl_->on(frame); }

}  // namespace rfmvo
