#include "vision/rematching.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/units.hpp"
#include "vision/patch_alignment.hpp"
#include "vision/reprojection.hpp"

namespace rfmvo {
namespace {

constexpr double kMaxViewAngle_rad = 30.0 * kPi / 180.0;     // between the old and the new sight line
constexpr double kMaxRealignAngle_rad = 10.0 * kPi / 180.0;  // measured: 8..25 degrees are alike
constexpr double kMaxSlip_px = 1.5;                          // of a track, that realigning mends; more is another thing
constexpr int kCoarsestLevel = 2;                            // finds what is up to about 15 px away
constexpr double kMargin_px = 12.0;                          // room for the patch

std::optional<Eigen::Vector2d> visible_at(const CameraModel& camera, const Eigen::Vector3d& p_C) {
  if (p_C.z() <= kMinDepth) return std::nullopt;
  const Eigen::Vector2d n = p_C.hnormalized();
  const double kWidest = camera.distortion == Distortion::kRadtan ? 1.5 : 2.5;  // radtan folds over beyond
  if (n.norm() > kWidest) return std::nullopt;
  const Eigen::Vector2d px = project(camera, n);
  const bool inside = px.x() > kMargin_px && px.y() > kMargin_px && px.x() < camera.width_px - kMargin_px &&
                      px.y() < camera.height_px - kMargin_px;
  return inside ? std::optional(px) : std::nullopt;
}

// The observation whose sight line is nearest to the new one.
const KeyframeObservation* best_observation(const Map& map, const Landmark& landmark, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d sight = (landmark.p_V - centre).normalized();
  const KeyframeObservation* best = nullptr;
  double best_cosine = std::cos(kMaxViewAngle_rad);
  for (const KeyframeObservation& o : landmark.observations) {
    const double cosine = sight.dot((landmark.p_V - map.find(o.keyframe)->T_C_V.centre()).normalized());
    if (cosine <= best_cosine) continue;
    best_cosine = cosine;
    best = &o;
  }
  return best;
}

// The oldest observation that still looks much the same from here.
const KeyframeObservation* oldest_observation(const Map& map, const Landmark& landmark, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d sight = (landmark.p_V - centre).normalized();
  for (const KeyframeObservation& o : landmark.observations) {
    const Eigen::Vector3d old = (landmark.p_V - map.find(o.keyframe)->T_C_V.centre()).normalized();
    if (sight.dot(old) > std::cos(kMaxRealignAngle_rad)) return &o;
  }
  return nullptr;
}

// How a small patch around the landmark, facing the old camera, changes from the new image to the old.
Eigen::Matrix2d warp(const ViewPose& T_K_V, const KeyframeObservation& o, const Eigen::Vector3d& p_V,
                     const ViewPose& T_C_V, const CameraModel& camera) {
  constexpr double kStep_px = 5.0;
  const double depth = (T_K_V * p_V).z();
  const auto seen = [&](double dx, double dy) {
    const Eigen::Vector2d n = o.normalised + Eigen::Vector2d(dx / camera.fx_px, dy / camera.fy_px);
    return project(camera, (T_C_V * T_K_V.to_V(depth * n.homogeneous())).hnormalized());
  };
  Eigen::Matrix2d A_to_from;
  A_to_from.col(0) = (seen(kStep_px, 0) - seen(-kStep_px, 0)) / (2 * kStep_px);
  A_to_from.col(1) = (seen(0, kStep_px) - seen(0, -kStep_px)) / (2 * kStep_px);
  return A_to_from.inverse();
}

}  // namespace

std::vector<Track> rematch(const Map& map, std::span<const Track> tracks, const Pyramid& pyramid, const ViewPose& T_C_V,
                           const CameraModel& camera, const RematchLimits& limits) {
  std::vector<Track> found;
  auto next = tracks.begin();
  const Eigen::Vector3d centre = T_C_V.centre();
  for (const auto& [id, landmark] : map.landmarks) {
    if (static_cast<int>(found.size()) >= limits.most) break;
    while (next != tracks.end() && next->landmark < id) ++next;
    const bool followed = next != tracks.end() && next->landmark == id;
    if (followed || !landmark.located) continue;
    const auto px = visible_at(camera, T_C_V * landmark.p_V);
    if (!px) continue;
    const KeyframeObservation* o = best_observation(map, landmark, centre);
    if (!o) continue;
    const Keyframe& from = *map.find(o->keyframe);
    const cv::Point2f predicted(static_cast<float>(px->x()), static_cast<float>(px->y()));
    const auto at = align_patch(from.pyramid, pyramid,
                                {o->px, predicted, warp(from.T_C_V, *o, landmark.p_V, T_C_V, camera)}, kCoarsestLevel);
    if (at && cv::norm(*at - predicted) <= limits.max_miss_px)
      found.push_back({id, *at, unproject(camera, {at->x, at->y}), 0, true});
  }
  return found;
}

void realign(const Map& map, std::span<Track> tracks, const Pyramid& pyramid, const ViewPose& T_C_V,
             const CameraModel& camera) {
  const Eigen::Vector3d centre = T_C_V.centre();
  for (Track& track : tracks) {
    const auto it = map.landmarks.find(track.landmark);
    if (it == map.landmarks.end() || !it->second.located || track.strikes > 0) continue;
    const Landmark& landmark = it->second;
    const KeyframeObservation* o = oldest_observation(map, landmark, centre);
    if (!o) continue;
    const Keyframe& from = *map.find(o->keyframe);
    const auto at =
        align_patch(from.pyramid, pyramid, {o->px, track.px, warp(from.T_C_V, *o, landmark.p_V, T_C_V, camera)}, 0);
    if (!at || cv::norm(*at - track.px) > kMaxSlip_px) continue;
    track.px = *at;
    track.normalised = unproject(camera, {at->x, at->y});
  }
}

}  // namespace rfmvo
