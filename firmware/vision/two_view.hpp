// Relative pose of two views of an unknown scene: candidates from an essential matrix AND from a
// homography, because planar walls and shelves defeat the first, deep scenes the second.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "vision/view_pose.hpp"

namespace rfmvo {

struct PointPair {
  Eigen::Vector2d first, second;  // normalised image planes
};

struct TwoViewHypothesis {
  ViewPose T_C2_C1;    // translation of length 1
  double score = 0.0;  // sum over pairs of gate^2 - error^2, px^2, of those in front of both and inside the gate
  int inliers = 0;
};

// Best score first; duplicates (same pose within a degree) are dropped. Empty: no hypothesis at all.
[[nodiscard]] std::vector<TwoViewHypothesis> two_view_hypotheses(std::span<const PointPair> pairs, double focal_px,
                                                                 double gate_px);

// Median error in px left when only a rotation explains the pairs: what translation there is shows here.
[[nodiscard]] double rotation_only_residual_px(std::span<const PointPair> pairs, double focal_px);

}  // namespace rfmvo
