#include "vision/map_tracker.hpp"

#include <algorithm>
#include <utility>

#include "vision/feature_tracks.hpp"
#include "vision/motion_drift.hpp"
#include "vision/relocalisation.hpp"
#include "vision/rematching.hpp"

namespace rfmvo {
namespace {

constexpr double kKeyframeFlow_rad = 20.0 / 520.0;  // VISION design: rotation-compensated, 20 px at f about 520 px
constexpr double kRematchFlow = 0.45;  // of that: old landmarks are looked for then, so that not all work comes at once
constexpr double kKeyframeCommon = 0.7;  // VISION design: of the last key frame's tracks
constexpr double kMotionHuber_px = 0.6;  // VISION design
constexpr double kRescueMiss_px = 10.0;  // as far as a patch is looked for
// The gate: what is this many sigmas off is another thing, even if it is only a pixel. With a fixed 2 px, people and
// repeated labels got in where pictures are good (shelfdiag: 0.06 % instead of 0.02); handheld frames need them.
constexpr double kGateSigmas = 6.0;
constexpr double kTightestGate = 0.4;       // of the configured gate: below, the map's own errors would be outliers
constexpr double kNoiseMemory = 0.9;        // of a frame's noise for the next
constexpr double kRayleighMedian = 1.1774;  // sqrt(2 ln 2): of the length of two axes' errors, in sigmas
constexpr int kMinInliers = 12;             // fewer: no pose
constexpr double kMinInlierShare = 0.4;     // of the located tracks: below, no pose
constexpr int kRelocaliseInliers = 40;      // three times as many as suffice on the way
constexpr double kRelocaliseShare = 0.7;    // of the patches that were found where they should be
constexpr double kSureMiss_px = 3.0;        // from where the map has it, once the pose is about right
constexpr double kWayBeyond = 2.0, kWaySlack = 0.3;  // a gap's way: of what the speed before it gives; of the depth
constexpr int kMaxStrikes = 3;                       // frames above the gate before a track is dropped
constexpr double kMaxExtrapolation = 3.0;            // frames; a constant velocity is not believed longer
constexpr double kDriftEvery_s = 0.3, kDriftLatest_s = 0.6;  // how often it is measured; the latter even on key frames
constexpr double kNearest = 0.1;                             // of the median depth: nearer points are not predicted

// What a key frame keeps for matching back: the images without their gradients, which are four times as large.
Pyramid images_only(const Pyramid& pyramid) {
  Pyramid images = pyramid;
  for (std::size_t i = 1; i < images.size(); i += 2) images[i].release();
  return images;
}

}  // namespace

void MapTracker::begin(Map map, std::vector<Track> tracks, Pyramid pyramid, std::int64_t next_landmark) {
  map_ = std::move(map);
  for (Keyframe& keyframe : map_.keyframes) keyframe.pyramid = images_only(keyframe.pyramid);
  tracks_ = std::move(tracks);
  next_landmark_ = next_landmark;
  const Keyframe& newest = map_.keyframes.back();
  const Keyframe& before = map_.keyframes[map_.keyframes.size() - 2];
  T_C_V_ = newest.T_C_V;
  motion_ = relative(newest.T_C_V, before.T_C_V);
  motion_s_ = (newest.time - before.time).seconds();
  pose_time_ = newest.time;
  for (std::size_t k = 0; k < map_.keyframes.size(); ++k) {
    const Keyframe& earlier = map_.keyframes[k > 0 ? k - 1 : 0];
    const Keyframe& later = map_.keyframes[std::min(k + 1, map_.keyframes.size() - 1)];
    map_.keyframes[k].twist = twist_between(earlier.T_C_V, later.T_C_V, (later.time - earlier.time).seconds());
  }
  twist_ = newest.twist;
  fill_up(pyramid);
  update_median_depth();
  settled_.add(pose_time_, T_C_V_, map_);
  previous_ = std::move(pyramid);
}

std::vector<SettledPose> MapTracker::take_settled(bool segment_ends) {
  return segment_ends ? settled_.rest(map_) : settled_.due(pose_time_, map_);
}

const Landmark* MapTracker::located(const Track& track) const {
  const auto it = map_.landmarks.find(track.landmark);
  return it != map_.landmarks.end() && it->second.located ? &it->second : nullptr;
}

ViewPose MapTracker::predict(DeviceTime time) const {
  const double dt = (time - pose_time_).seconds();
  const double ratio = motion_s_ > 0.0 ? std::clamp(dt / motion_s_, 0.0, kMaxExtrapolation) : 0.0;
  return composed({so3_exp(ratio * so3_log(motion_.R_C_V)), ratio * motion_.t_C_V}, T_C_V_);
}

std::vector<cv::Point2f> MapTracker::predict_tracks(const ViewPose& predicted) const {
  std::vector<cv::Point2f> result;
  for (const Track& t : tracks_) {
    const Landmark* landmark = located(t);
    const Eigen::Vector3d p_V = landmark ? landmark->p_V : T_C_V_.to_V(median_depth_ * t.normalised.homogeneous());
    const Eigen::Vector3d p_C = predicted * p_V;
    result.push_back(t.px);
    if (p_C.z() < kNearest * median_depth_) continue;
    const Eigen::Vector2d px = project(lens_.camera(), p_C.hnormalized());
    result.back() = {static_cast<float>(px.x()), static_cast<float>(px.y())};
  }
  return result;
}

MotionSolution MapTracker::locate_camera(const ViewPose& predicted, DeviceTime time,
                                         std::vector<Track>& followed) const {
  const Twist twist = twist_between(T_C_V_, predicted, (time - pose_time_).seconds());
  std::vector<MotionObservation> seen;
  std::vector<std::size_t> track_of;
  for (std::size_t i = 0; i < followed.size(); ++i) {
    const Landmark* landmark = located(followed[i]);
    if (!landmark) continue;
    const Track& t = followed[i];
    seen.push_back({landmark->p_V, lens_.at_stamp(t.normalised, t.px.y, predicted * landmark->p_V, twist),
                    image_scale(lens_.camera(), t.normalised)});
    track_of.push_back(i);
  }
  const MotionOptions options{options_.mapping.focal_px, kMotionHuber_px, options_.mapping.gate_px};
  const auto enough = [&seen](const MotionSolution& m) {
    return m.inliers >= kMinInliers && m.inliers >= kMinInlierShare * static_cast<double>(seen.size());
  };
  MotionSolution s = solve_motion(seen, predicted, options);
  if (!enough(s)) {
    MotionSolution global = solve_motion_globally(seen, predicted, options);
    if (global.inliers > s.inliers) s = std::move(global);
  }
  if (!enough(s)) s.inliers = 0;
  for (std::size_t k = 0; k < track_of.size(); ++k) {
    Track& t = followed[track_of[k]];
    t.strikes = s.error_px[k] <= options.gate_px ? 0 : t.fresh ? kMaxStrikes : t.strikes + 1;
  }
  return s;
}

std::optional<TrackedPose> MapTracker::on(DeviceTime time, const Pyramid& pyramid) {
  const ViewPose predicted = predict(time);
  std::vector<Track> followed = advanced(tracks_, previous_, pyramid, predict_tracks(predicted), lens_.camera());
  MotionSolution s = locate_camera(predicted, time, followed);
  if (s.inliers == 0) {
    // The light has changed at once, or pictures are missing: the map's patches, gain and offset free, may still be
    // found about where they should be.
    followed = rematch(map_, {}, pyramid, predicted, lens_.camera(), {options_.max_tracks, kRescueMiss_px});
    for (Track& t : followed) t.fresh = false;
    s = locate_camera(predicted, time, followed);
  }
  if (s.inliers == 0) return std::nullopt;
  realign(map_, followed, pyramid, s.T_C_V, lens_.camera());
  s = locate_camera(s.T_C_V, time, followed);
  if (s.inliers == 0) return std::nullopt;
  return accept(time, pyramid, std::move(followed), s);
}

std::optional<TrackedPose> MapTracker::relocalise(DeviceTime time, const Pyramid& pyramid) {
  const MotionOptions wide{options_.mapping.focal_px, kMotionHuber_px, widest_gate_px_};
  const double ratio = motion_s_ > 0.0 ? (time - pose_time_).seconds() / motion_s_ : 0.0;
  const ViewPose going_on = composed({so3_exp(ratio * so3_log(motion_.R_C_V)), ratio * motion_.t_C_V}, T_C_V_);
  const auto guess = guess_pose(map_, lens_, pyramid[0], going_on, wide);
  if (!guess) return std::nullopt;
  const double way = (guess->centre() - T_C_V_.centre()).norm();
  if (way > kWayBeyond * ratio * motion_.t_C_V.norm() + kWaySlack * median_depth_) return std::nullopt;
  std::vector<Track> followed =
      rematch(map_, {}, pyramid, *guess, lens_.camera(), {options_.max_tracks, kRescueMiss_px});
  MotionSolution s = locate_camera(*guess, time, followed);
  if (s.inliers < kRelocaliseInliers) return std::nullopt;
  followed = rematch(map_, {}, pyramid, s.T_C_V, lens_.camera(), {options_.max_tracks, kSureMiss_px});
  s = locate_camera(s.T_C_V, time, followed);
  const bool sure =
      s.inliers >= kRelocaliseInliers && s.inliers >= kRelocaliseShare * static_cast<double>(followed.size());
  if (!sure) return std::nullopt;
  const double keyframes = way / (median_depth_ * kKeyframeFlow_rad);
  TrackedPose pose = accept(time, pyramid, std::move(followed), s);
  pose.keyframe_share = std::max(pose.keyframe_share, keyframes);
  pose.relocalised = true;
  return pose;
}

TrackedPose MapTracker::accept(DeviceTime time, const Pyramid& pyramid, std::vector<Track> followed,
                               const MotionSolution& s) {
  update_gate(s);
  update_motion(s.T_C_V, time);
  tracks_ = std::move(followed);
  std::erase_if(tracks_, [](const Track& t) { return t.strikes >= kMaxStrikes; });
  std::ptrdiff_t kept = 0;  // located before this frame
  for (Track& t : tracks_) {
    t.fresh = false;
    kept += located(t) != nullptr;
  }
  locate_landmarks(map_, tracks_, T_C_V_, twist_, lens_, median_depth_, options_.mapping);
  update_median_depth();
  settled_.add(time, T_C_V_, map_);
  const double flow = flow_since_keyframe();
  const bool keyframe = flow >= 1.0;
  if (!rematched_ && flow >= kRematchFlow) rematch_tracks(pyramid);
  if (keyframe) add_keyframe(time, pyramid);
  previous_ = pyramid;
  const double share = std::min(1.0, static_cast<double>(s.inliers) / static_cast<double>(kept));
  const double keyframe_share = spend_flow(flow);
  update_drift(time);
  return TrackedPose{T_C_V_, s.inliers, share, median_depth_, s.covariance, keyframe_share};
}

double MapTracker::spend_flow(double flow) {
  const double share = std::max(0.0, std::min(flow, 1.0) - flow_);
  flow_ = flow >= 1.0 ? 0.0 : std::max(flow_, flow);
  return share;
}

void MapTracker::update_drift(DeviceTime time) {
  if (map_.keyframes.back().time <= drift_time_) return;  // as measured
  const double since_s = (time - drift_time_).seconds();
  const bool busy = map_.keyframes.back().time == time;
  if (drift_ && (since_s < kDriftEvery_s || (busy && since_s < kDriftLatest_s))) return;
  if (auto drift = drift_per_keyframe(map_, lens_, options_.mapping)) drift_ = std::move(drift);
  drift_time_ = time;
}

void MapTracker::update_motion(const ViewPose& T_C_V, DeviceTime time) {
  motion_ = relative(T_C_V, T_C_V_);
  motion_s_ = (time - pose_time_).seconds();
  const Twist twist = twist_between(T_C_V_, T_C_V, motion_s_);
  Keyframe& keyframe = map_.keyframes.back();
  if (keyframe.time == pose_time_) {  // now it is known how it went on
    keyframe.twist.omega_rad_s = 0.5 * (twist_.omega_rad_s + twist.omega_rad_s);
    keyframe.twist.v_s = 0.5 * (twist_.v_s + twist.v_s);
  }
  twist_ = twist;
  T_C_V_ = T_C_V;
  pose_time_ = time;
}

void MapTracker::update_gate(const MotionSolution& solution) {
  std::vector<double> errors = solution.error_px;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  const double noise_px = std::min(*middle / kRayleighMedian, widest_gate_px_);
  noise_px_ = kNoiseMemory * noise_px_ + (1.0 - kNoiseMemory) * noise_px;
  options_.mapping.gate_px = std::clamp(kGateSigmas * noise_px_, kTightestGate * widest_gate_px_, widest_gate_px_);
}

void MapTracker::update_median_depth() {
  std::vector<double> depths;
  for (const Track& t : tracks_) {
    if (const Landmark* landmark = located(t)) depths.push_back((T_C_V_ * landmark->p_V).z());
  }
  if (depths.empty()) return;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  median_depth_ = *middle;
}

double MapTracker::flow_since_keyframe() const {
  const Keyframe& last = map_.keyframes.back();
  const Eigen::Quaterniond R = T_C_V_.R_C_V * last.T_C_V.R_C_V.conjugate();
  std::vector<double> flows;
  for (const Track& t : tracks_) {
    const auto it = map_.landmarks.find(t.landmark);
    if (it == map_.landmarks.end() || it->second.observations.empty()) continue;
    const KeyframeObservation& o = it->second.observations.back();
    if (o.keyframe != last.id) continue;
    flows.push_back((t.normalised - (R * o.normalised.homogeneous()).hnormalized()).norm());
  }
  if (flows.empty() || static_cast<double>(flows.size()) < kKeyframeCommon * static_cast<double>(keyframe_tracks_)) {
    return 1.0;
  }
  const auto middle = flows.begin() + static_cast<std::ptrdiff_t>(flows.size() / 2);
  std::nth_element(flows.begin(), middle, flows.end());
  return *middle / kKeyframeFlow_rad;
}

void MapTracker::rematch_tracks(const Pyramid& pyramid) {
  // At most half of the tracks: the other half must be new parts of the scene.
  const std::vector<Track> again =
      rematch(map_, tracks_, pyramid, T_C_V_, lens_.camera(), {.most = options_.max_tracks / 2});
  tracks_.insert(tracks_.end(), again.begin(), again.end());
  std::sort(tracks_.begin(), tracks_.end(), [](const Track& a, const Track& b) { return a.landmark < b.landmark; });
  rematched_ = true;
}

void MapTracker::add_keyframe(DeviceTime time, const Pyramid& pyramid) {
  const std::int64_t id = map_.keyframes.back().id + 1;
  map_.keyframes.push_back({id, time, T_C_V_, images_only(pyramid), twist_});
  settled_.tie(map_, T_C_V_);
  for (const Track& t : tracks_) {
    if (t.strikes == 0) map_.landmarks[t.landmark].observations.push_back({id, t.px, t.normalised});
  }
  adjust_window(map_, lens_, options_.mapping);
  if (lens_.is_free()) {
    for (Track& t : tracks_) t.normalised = unproject(lens_.camera(), {t.px.x, t.px.y});
  }
  T_C_V_ = map_.keyframes.back().T_C_V;
  fill_up(pyramid);
  forget_old(map_, tracks_, options_.mapping);
  rematched_ = false;
}

void MapTracker::fill_up(const Pyramid& pyramid) {
  const std::size_t old = tracks_.size();
  refill(tracks_, pyramid[0], lens_.camera(), options_.max_tracks, next_landmark_);
  const std::int64_t id = map_.keyframes.back().id;
  for (std::size_t i = old; i < tracks_.size(); ++i) {
    map_.landmarks[tracks_[i].landmark].observations.push_back({id, tracks_[i].px, tracks_[i].normalised});
  }
  keyframe_tracks_ = tracks_.size();
}

}  // namespace rfmvo
