#include "vision/mapping.hpp"

#include <algorithm>
#include <set>

#include "vision/bundle_adjustment.hpp"
#include "vision/reprojection.hpp"
#include "vision/triangulation.hpp"

namespace rfmvo {
namespace {

constexpr double kBundleHuber_px = 1.0;
constexpr int kBundleIterations = 3;    // the window was adjusted at the key frame before; measured: 5 change nothing
constexpr double kCullGate = 1.5;       // of the gate: an observation's error after the adjustment
constexpr std::size_t kGaugeViews = 2;  // VISION design: the oldest 2..5 key frames of a full window stay fixed

struct Window {
  BundleProblem bundle;
  std::vector<std::int64_t> keyframes;  // of the views
  std::vector<std::int64_t> landmarks;  // of the points
};

bool in_window(const Landmark& landmark, std::int64_t first) {
  return landmark.located && landmark.observations.size() >= 2 && landmark.observations.back().keyframe >= first;
}

// The sight line of an observation as it would have been at the key frame's stamp.
Eigen::Vector2d at_stamp(const Keyframe& keyframe, const KeyframeObservation& o, const Eigen::Vector3d& p_V,
                         const Lens& lens) {
  return lens.at_stamp(o.normalised, o.px.y, keyframe.T_C_V * p_V, keyframe.twist);
}

BundleObservation observed(const Keyframe& keyframe, const KeyframeObservation& o, const Eigen::Vector3d& p_V,
                           const Lens& lens) {
  BundleObservation result;
  result.measured = at_stamp(keyframe, o, p_V, lens);
  result.scale = image_scale(lens.camera(), o.normalised);
  if (lens.is_asked()) result.d_lens = lens.d_at_stamp(o.normalised, o.px.y, keyframe.T_C_V * p_V, keyframe.twist);
  return result;
}

Window gather(const Map& map, const Lens& lens, std::int64_t first) {
  Window w;
  std::vector<int> view_of(map.keyframes.size(), -1);
  const std::int64_t oldest = map.keyframes.front().id;
  for (const auto& [id, landmark] : map.landmarks) {
    if (!in_window(landmark, first)) continue;
    for (const KeyframeObservation& o : landmark.observations)
      view_of[static_cast<std::size_t>(o.keyframe - oldest)] = 0;
  }
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    if (view_of[k] < 0) continue;
    view_of[k] = static_cast<int>(w.keyframes.size());
    w.keyframes.push_back(map.keyframes[k].id);
    w.bundle.views.push_back({map.keyframes[k].T_C_V, map.keyframes[k].id < first});
  }
  for (const auto& [id, landmark] : map.landmarks) {
    if (!in_window(landmark, first)) continue;
    const auto point = static_cast<int>(w.landmarks.size());
    w.landmarks.push_back(id);
    w.bundle.points_V.push_back(landmark.p_V);
    for (const KeyframeObservation& o : landmark.observations) {
      w.bundle.observations.push_back(observed(*map.find(o.keyframe), o, landmark.p_V, lens));
      w.bundle.observations.back().view = view_of[static_cast<std::size_t>(o.keyframe - oldest)];
      w.bundle.observations.back().point = point;
    }
  }
  w.bundle.lens = {lens.is_asked(), LensVector::Zero(), lens.expected_step(), lens.information()};
  return w;
}

// Keeps the size of the path: the factor that fits the new camera centres, seen from the first, to the old ones.
void keep_scale(const std::vector<BundleView>& before, Window& w) {
  const ViewPose& origin = w.bundle.views.front().T_C_V;
  double old_new = 0.0, new_new = 0.0;
  for (std::size_t v = 1; v < before.size(); ++v) {
    const Eigen::Vector3d now = w.bundle.views[v].T_C_V.centre() - origin.centre();
    old_new += now.dot(before[v].T_C_V.centre() - origin.centre());
    new_new += now.squaredNorm();
  }
  if (!(old_new > 0.0) || !(new_new > 0.0)) return;
  const double scale = old_new / new_new;
  for (std::size_t v = 1; v < before.size(); ++v) {
    ViewPose& pose = w.bundle.views[v].T_C_V;
    const Eigen::Vector3d centre = origin.centre() + scale * (pose.centre() - origin.centre());
    pose.t_C_V = -(pose.R_C_V * centre);
  }
  for (Eigen::Vector3d& p : w.bundle.points_V) p = origin.centre() + scale * (p - origin.centre());
}

// Turns and shifts everything so that the newest camera is where it was: the path goes on without a jump.
void keep_newest(const BundleView& before, Window& w) {
  const ViewPose now = w.bundle.views.back().T_C_V;
  for (Eigen::Vector3d& p : w.bundle.points_V) p = before.T_C_V.to_V(now * p);
  for (BundleView& view : w.bundle.views) view.T_C_V = composed(relative(view.T_C_V, now), before.T_C_V);
}

void write_back(Map& map, const Window& w, const Lens& lens, const MappingOptions& options) {
  for (std::size_t v = 0; v < w.keyframes.size(); ++v) map.find(w.keyframes[v])->T_C_V = w.bundle.views[v].T_C_V;
  for (std::size_t p = 0; p < w.landmarks.size(); ++p) {
    Landmark& landmark = map.landmarks.at(w.landmarks[p]);
    landmark.p_V = w.bundle.points_V[p];
    std::erase_if(landmark.observations, [&](const KeyframeObservation& o) {
      const Keyframe& keyframe = *map.find(o.keyframe);
      const Eigen::Vector2d measured = at_stamp(keyframe, o, landmark.p_V, lens);
      const Reprojection r = reproject(keyframe.T_C_V * landmark.p_V, measured,
                                       options.focal_px * image_scale(lens.camera(), o.normalised));
      return !r.in_front || r.error_px.norm() > kCullGate * options.gate_px;
    });
    if (landmark.observations.size() < 2) landmark.located = false;
  }
}

void undistort_again(Map& map, const CameraModel& camera) {
  for (auto& [id, landmark] : map.landmarks) {
    for (KeyframeObservation& o : landmark.observations) o.normalised = unproject(camera, {o.px.x, o.px.y});
  }
}

}  // namespace

void locate_landmarks(Map& map, std::span<const Track> tracks, const ViewPose& T_C_V, const Twist& twist,
                      const Lens& lens, double depth, const MappingOptions& options) {
  std::vector<SightLine> lines;
  for (const Track& track : tracks) {
    Landmark& landmark = map.landmarks[track.landmark];
    if (landmark.located || landmark.observations.empty()) continue;
    lines.clear();
    const Eigen::Vector3d rough_V = T_C_V.to_V(depth * track.normalised.homogeneous());
    for (const KeyframeObservation& o : landmark.observations) {
      const Keyframe& keyframe = *map.find(o.keyframe);
      lines.push_back({keyframe.T_C_V, at_stamp(keyframe, o, rough_V, lens), image_scale(lens.camera(), o.normalised)});
    }
    lines.push_back({T_C_V, lens.at_stamp(track.normalised, track.px.y, T_C_V * rough_V, twist),
                     image_scale(lens.camera(), track.normalised)});
    if (const auto p = triangulate(lines, options.min_parallax_rad, options.focal_px, options.gate_px)) {
      landmark.located = true;
      landmark.p_V = *p;
    }
  }
}

void adjust_window(Map& map, Lens& lens, const MappingOptions& options) {
  if (map.keyframes.size() < 2) return;
  const std::int64_t newest = map.keyframes.back().id;
  const bool full = static_cast<int>(map.keyframes.size()) > options.window && !lens.is_settling();
  const std::int64_t first = full ? newest - options.window + 1 : map.keyframes.front().id;
  Window w = gather(map, lens, first);
  if (w.bundle.views.size() < 2) return;
  if (full) {
    for (std::size_t v = 0; v < kGaugeViews && v + 1 < w.bundle.views.size(); ++v) w.bundle.views[v].fixed = true;
  } else {
    w.bundle.views.front().fixed = true;
  }
  const std::vector<BundleView> before = w.bundle.views;
  const BundleReport report = adjust_bundle(w.bundle, {options.focal_px, kBundleHuber_px, kBundleIterations});
  if (!full) keep_scale(before, w);
  if (lens.is_settling()) keep_newest(before.back(), w);
  if (w.bundle.lens.free) {
    lens.learn(w.bundle.lens.step, report.lens_information, report.lens_pull);
    if (w.bundle.lens.step(0) != 0.0) undistort_again(map, lens.camera());
  } else {
    lens.skip();
  }
  write_back(map, w, lens, options);
}

void forget_old(Map& map, std::span<const Track> tracks, const MappingOptions& options) {
  while (static_cast<int>(map.keyframes.size()) > options.archive) map.keyframes.pop_front();
  std::set<std::int64_t> followed;
  for (const Track& track : tracks) followed.insert(track.landmark);
  const std::int64_t oldest = map.keyframes.empty() ? 0 : map.keyframes.front().id;
  for (auto it = map.landmarks.begin(); it != map.landmarks.end();) {
    auto& observations = it->second.observations;
    std::erase_if(observations, [oldest](const KeyframeObservation& o) { return o.keyframe < oldest; });
    const bool useful = followed.contains(it->first) || (it->second.located && observations.size() >= 2);
    it = useful ? std::next(it) : map.landmarks.erase(it);
  }
}

}  // namespace rfmvo
