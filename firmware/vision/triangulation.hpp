// Where a point is, from its sight lines.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "vision/view_pose.hpp"

namespace rfmvo {

struct SightLine {
  ViewPose T_C_V;
  Eigen::Vector2d measured;  // normalised image plane, undistorted
  double scale = 1.0;        // image_scale() there
};

// Angle at the point between two sight lines' directions in V, rad.
[[nodiscard]] double parallax(const SightLine& a, const SightLine& b);

// Least squares over all lines (start: the middle of the shortest segment between the first and the
// last). No value if the parallax of first and last is below min_parallax_rad, the point is not in
// front of every view, or its error exceeds gate_px in one of them.
[[nodiscard]] std::optional<Eigen::Vector3d> triangulate(std::span<const SightLine> lines, double min_parallax_rad,
                                                         double focal_px, double gate_px);

}  // namespace rfmvo
