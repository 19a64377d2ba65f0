// How far off the camera's motion is, as the window's own residuals show it.
#pragma once

#include <optional>

#include "vision/lens.hpp"
#include "vision/map.hpp"
#include "vision/mapping.hpp"

namespace rfmvo {

// Covariance of the newest key frame's pose against that of a key frame kDriftHorizon_s earlier (step of moved(), in
// units of V), for each key frame between them: the sum over these is the covariance of the motion.
//
// Not sigma^2 H^-1 of the bundle adjustment, which promises five times too much (variance, rendered drives): errors of
// one landmark are alike in all its views (a patch that slips, an edge), and those of neighbours may be alike too (what
// moves by itself, a warped picture). Each landmark pulls the motion its way; at the minimum the pulls balance, and
// their scatter is the covariance (cluster-robust, Liang and Zeger 1986), whatever the errors of one landmark have in
// common. Once by landmarks and once by regions; in every direction the larger counts. A lens whose
// calibration the images have not confirmed is one more that pulls, as far as it is not known by now.
//
// No value: too few key frames or landmarks.
[[nodiscard]] std::optional<Matrix6d> drift_per_keyframe(const Map& map, const Lens& lens,
                                                         const MappingOptions& options);

inline constexpr double kDriftHorizon_s = 1.0;

}  // namespace rfmvo
