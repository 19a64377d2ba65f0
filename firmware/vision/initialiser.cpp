#include "vision/initialiser.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "vision/motion_solver.hpp"
#include "vision/reprojection.hpp"
#include "vision/triangulation.hpp"

namespace rfmvo {
namespace {

// VISION design: a flow of 18..20 px at 640x480 (f about 520 px) before the start is tried.
constexpr double kMinFlow_rad = 18.0 / 520.0;
const double kViewFlow_rad = kMinFlow_rad / 4.0;  // a view to keep on the way
constexpr double kMinRotationResidual_px = 1.0;   // twice what KLT noise and a poor calibration leave
constexpr std::size_t kMinPairs = 40;
constexpr double kMinCommon = 0.5;  // of the reference's tracks
constexpr std::size_t kMaxViews = 12;
constexpr double kRivalScore = 0.7;  // of the best: worth building
constexpr std::size_t kMaxRivals = 4;
constexpr double kRivalCost = 1.25;  // the runner-up must be this much worse, or be the same pose
constexpr double kSamePose_rad = 2.0 * kPi / 180.0;
constexpr double kMinInliers = 0.6;       // of the pairs
constexpr double kMissingCost_px2 = 0.3;  // of a pair that got no place; measured: 0.1..1 are alike
constexpr double kMaxMeanCost_px2 = 2.0;
constexpr std::size_t kMinPoints = kMinPairs / 2;
constexpr double kMinPointParallax = 0.3;  // of the median's gate: far points may have less than the median
constexpr double kViewsGate = 1.5;         // of the gate: more views than two, as many chances to exceed it
constexpr double kLooseGate = 4.0;         // of the gate, before the first adjustment
constexpr double kBundleHuber_px = 1.0;
constexpr int kBundleIterations = 15;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

const Track* find_track(const std::vector<Track>& tracks, std::int64_t landmark) {
  const auto it = std::lower_bound(tracks.begin(), tracks.end(), landmark,
                                   [](const Track& t, std::int64_t id) { return t.landmark < id; });
  return it != tracks.end() && it->landmark == landmark ? &*it : nullptr;
}

// V becomes the last key frame's camera frame, with a median depth of 1.
void normalise(Map& map) {
  const ViewPose origin = map.keyframes.back().T_C_V;
  std::vector<double> depths;
  for (const auto& [id, landmark] : map.landmarks) {
    if (landmark.located) depths.push_back((origin * landmark.p_V).z());
  }
  const double scale = 1.0 / median(depths);
  for (auto& [id, landmark] : map.landmarks) {
    if (landmark.located) landmark.p_V = scale * (origin * landmark.p_V);
  }
  const ViewPose T_V_old = {origin.R_C_V.conjugate(), -(origin.R_C_V.conjugate() * origin.t_C_V)};
  for (Keyframe& keyframe : map.keyframes) {
    keyframe.T_C_V = composed(keyframe.T_C_V, T_V_old);
    keyframe.T_C_V.t_C_V *= scale;
  }
  map.keyframes.back().T_C_V = ViewPose{};
}

}  // namespace

std::vector<Initialiser::Pair> Initialiser::common(const View& view, std::span<const Track> tracks) {
  std::vector<Pair> pairs;
  for (const Track& track : tracks) {
    if (const Track* first = find_track(view.tracks, track.landmark)) pairs.push_back({*first, track});
  }
  return pairs;
}

double Initialiser::median_flow_rad(const std::vector<Pair>& pairs) {
  std::vector<double> flows;
  for (const Pair& pair : pairs) flows.push_back((pair.second.normalised - pair.first.normalised).norm());
  return median(std::move(flows));
}

void Initialiser::remember(View view) {
  views_.push_back(std::move(view));
  if (views_.size() <= kMaxViews) return;
  std::vector<View> kept;
  for (std::size_t i = 0; i < views_.size(); i += 2) kept.push_back(std::move(views_[i]));
  views_.swap(kept);
}

std::optional<Map> Initialiser::on(DeviceTime time, const Pyramid& pyramid, std::span<const Track> tracks) {
  View current{time, pyramid, {tracks.begin(), tracks.end()}};
  std::vector<Pair> pairs;
  while (!views_.empty()) {
    pairs = common(views_.front(), tracks);
    const double least = std::max(1.0 * kMinPairs, kMinCommon * static_cast<double>(views_.front().tracks.size()));
    if (static_cast<double>(pairs.size()) >= least) break;
    views_.erase(views_.begin());
  }
  if (views_.empty()) {
    if (tracks.size() >= kMinPairs) remember(std::move(current));
    return std::nullopt;
  }
  if (median_flow_rad(common(views_.back(), tracks)) < kViewFlow_rad) return std::nullopt;
  if (median_flow_rad(pairs) >= kMinFlow_rad) {
    if (auto map = attempt(pairs, current)) return map;
  }
  remember(std::move(current));
  return std::nullopt;
}

// The best is clear if every rival is clearly worse or ends at the same pose.
bool Initialiser::is_clear(const std::vector<Candidate>& candidates) {
  const Candidate& best = candidates.front();
  for (const Candidate& rival : candidates) {
    const Eigen::Quaterniond& a = best.map.keyframes.front().T_C_V.R_C_V;
    const bool same = a.angularDistance(rival.map.keyframes.front().T_C_V.R_C_V) < kSamePose_rad;
    if (!same && rival.cost_px2 < kRivalCost * best.cost_px2) return false;
  }
  return true;
}

std::optional<Map> Initialiser::attempt(const std::vector<Pair>& pairs, const View& current) {
  std::vector<PointPair> points;
  for (const Pair& pair : pairs) points.push_back({pair.first.normalised, pair.second.normalised});
  if (rotation_only_residual_px(points, options_.focal_px) < kMinRotationResidual_px) return std::nullopt;
  const auto hypotheses = two_view_hypotheses(points, options_.focal_px, options_.gate_px);
  std::vector<Candidate> candidates;
  for (const TwoViewHypothesis& h : hypotheses) {
    if (candidates.size() == kMaxRivals || h.score < kRivalScore * hypotheses.front().score) break;
    if (auto candidate = build(h, pairs, current)) candidates.push_back(std::move(*candidate));
  }
  if (candidates.empty()) return std::nullopt;
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost_px2 < b.cost_px2; });
  Candidate& best = candidates.front();
  const bool good = best.points >= kMinInliers * static_cast<double>(pairs.size()) &&
                    best.parallax_rad >= options_.min_parallax_rad && best.cost_px2 <= kMaxMeanCost_px2;
  if (!good || !is_clear(candidates)) return std::nullopt;
  return std::move(best.map);
}

std::optional<Initialiser::Candidate> Initialiser::build(const TwoViewHypothesis& hypothesis,
                                                         const std::vector<Pair>& pairs, const View& current) const {
  std::vector<const View*> views;
  for (const View& view : views_) views.push_back(&view);
  views.push_back(&current);
  BundleProblem bundle;
  std::vector<std::int64_t> ids;  // landmarks of the bundle's points
  for (const Pair& pair : pairs) {
    const SightLine lines[2] = {{ViewPose{}, pair.first.normalised}, {hypothesis.T_C2_C1, pair.second.normalised}};
    const auto p =
        triangulate(lines, kMinPointParallax * options_.min_parallax_rad, options_.focal_px, options_.gate_px);
    if (!p) continue;
    bundle.points_V.push_back(*p);
    ids.push_back(pair.first.landmark);
  }
  if (ids.size() < kMinPoints) return std::nullopt;
  add_views(views, ids, hypothesis.T_C2_C1, bundle);
  const BundleReport report = adjust_bundle(bundle, {options_.focal_px, kBundleHuber_px, kBundleIterations});
  Candidate candidate;
  candidate.cost_px2 = report.final_cost / static_cast<double>(bundle.observations.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto id = static_cast<std::int64_t>(v);
    candidate.map.keyframes.push_back({id, views[v]->time, bundle.views[v].T_C_V, views[v]->pyramid, {}});
    for (const Track& t : views[v]->tracks) {
      candidate.map.landmarks[t.landmark].observations.push_back({id, t.px, t.normalised});
    }
  }
  locate(ids, candidate);
  if (candidate.points < static_cast<int>(kMinPoints)) return std::nullopt;
  // A pair without a place is not free: else the hypothesis that explains the fewest would win.
  const double missing = 1.0 - candidate.points / static_cast<double>(pairs.size());
  candidate.cost_px2 += missing * kMissingCost_px2;
  normalise(candidate.map);
  return candidate;
}

// Poses of the views between the first and the last from the points that these two gave, one after the other.
void Initialiser::add_views(const std::vector<const View*>& views, const std::vector<std::int64_t>& ids,
                            const ViewPose& last, BundleProblem& bundle) const {
  const MotionOptions loose{options_.focal_px, options_.gate_px, kLooseGate * options_.gate_px};
  ViewPose pose;
  for (std::size_t v = 0; v < views.size(); ++v) {
    std::vector<MotionObservation> seen;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (const Track* t = find_track(views[v]->tracks, ids[i])) seen.push_back({bundle.points_V[i], t->normalised});
    }
    if (v + 1 == views.size()) pose = last;
    if (v > 0) pose = solve_motion(seen, pose, loose).T_C_V;
    bundle.views.push_back({pose, v == 0});
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      const Track* t = find_track(views[v]->tracks, ids[i]);
      if (t) bundle.observations.push_back({static_cast<int>(v), static_cast<int>(i), t->normalised});
    }
  }
}

// The landmarks' places from the adjusted poses; those that do not fit all their views stay without one.
void Initialiser::locate(const std::vector<std::int64_t>& ids, Candidate& candidate) const {
  std::vector<double> parallaxes;
  for (const std::int64_t id : ids) {
    Landmark& landmark = candidate.map.landmarks[id];
    std::vector<SightLine> lines;
    for (const KeyframeObservation& o : landmark.observations) {
      lines.push_back({candidate.map.find(o.keyframe)->T_C_V, o.normalised});
    }
    const auto p = triangulate(lines, kMinPointParallax * options_.min_parallax_rad, options_.focal_px,
                               kViewsGate * options_.gate_px);
    if (!p) continue;
    landmark.located = true;
    landmark.p_V = *p;
    parallaxes.push_back(parallax(lines.front(), lines.back()));
  }
  candidate.points = static_cast<int>(parallaxes.size());
  candidate.parallax_rad = median(std::move(parallaxes));
}

}  // namespace rfmvo
