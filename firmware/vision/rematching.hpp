// "Matching back": landmarks that were lost from sight are looked for again where the map says they
// must be. What is found ties the newest view to old ones, which stops drift when a place is revisited.
#pragma once

#include <span>
#include <vector>

#include "geometry/camera_model.hpp"
#include "vision/map.hpp"

namespace rfmvo {

// New tracks, sorted by landmark, of located landmarks of the map that are not among `tracks`;
// farther than max_miss_px from where the map has it, a match is something else.
struct RematchLimits {
  int most = 100;
  double max_miss_px = 5.0;
};
[[nodiscard]] std::vector<Track> rematch(const Map& map, std::span<const Track> tracks, const Pyramid& pyramid,
                                         const ViewPose& T_C_V, const CameraModel& camera, const RematchLimits& limits);

// Puts each located track back onto what its landmark looked like when first seen, which takes out the
// slow slip of frame-to-frame tracking.
void realign(const Map& map, std::span<Track> tracks, const Pyramid& pyramid, const ViewPose& T_C_V,
             const CameraModel& camera);

}  // namespace rfmvo
