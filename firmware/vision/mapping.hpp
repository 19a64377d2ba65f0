// How the map grows and is kept right: new points, windowed adjustment, and what is thrown away.
#pragma once

#include <span>

#include "vision/lens.hpp"
#include "vision/map.hpp"

namespace rfmvo {

struct MappingOptions {
  double focal_px = 500.0;
  double gate_px = 2.0;
  double min_parallax_rad = 0.0175;
  int window = 10;   // newest key frames that the adjustment moves
  int archive = 40;  // key frames kept in all
};

// Locates followed landmarks that have parallax by now, with the current view as the last sight line;
// `depth` is about that of the scene from here.
void locate_landmarks(Map& map, std::span<const Track> tracks, const ViewPose& T_C_V, const Twist& twist,
                      const Lens& lens, double depth, const MappingOptions& options);

// Bundle adjustment of the newest key frames and all landmarks they see; older key frames that see
// them stay fixed. Until there are older ones, the first pose and the scale of the path are kept.
// A free lens is adjusted, too; the landmarks' sight lines then follow it. While it settles, all key
// frames are adjusted: old ones that stayed would hold it where it was.
void adjust_window(Map& map, Lens& lens, const MappingOptions& options);

// Drops key frames beyond the archive, and landmarks that neither a key frame nor a track needs.
void forget_old(Map& map, std::span<const Track> tracks, const MappingOptions& options);

}  // namespace rfmvo
