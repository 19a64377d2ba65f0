// Eq. (13), (14), (17): the point nearest to M x L lines through the antenna elements along the
// incident directions, by singular value decomposition.
#pragma once

#include <Eigen/Core>
#include <span>

namespace rfmvo {

struct Line {
  Eigen::Vector3d point;      // the antenna element
  Eigen::Vector3d direction;  // unit vector (u, v, w) of Eq. (15)
};

struct LineIntersection {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  bool determined = false;  // false: fewer than two lines, or all of them parallel
};

// Minimises the sum of squared distances from the point to the lines.
[[nodiscard]] LineIntersection nearest_point(std::span<const Line> lines);

}  // namespace rfmvo
