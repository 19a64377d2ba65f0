#include "estimator/line_intersection.hpp"

#include <Eigen/SVD>

namespace rfmvo {
namespace {

// Smallest over largest singular value. It is about the mean squared angle between the lines, so
// this is 0.06 deg: below it the intersection is noise of the search grid.
constexpr double kMinCondition = 1e-6;

}  // namespace

LineIntersection nearest_point(std::span<const Line> lines) {
  if (lines.empty()) return {};
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Line& line : lines) centre += line.point;
  centre /= static_cast<double>(lines.size());

  // (I - u u') (X - p) is the offset of X from a line: Eq. (13) as normal equations.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Line& line : lines) {
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - line.direction * line.direction.transpose();
    normal += across;
    right += across * (line.point - centre);
  }
  Eigen::JacobiSVD<Eigen::Matrix3d> svd(normal, Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(kMinCondition);
  return {centre + svd.solve(right), svd.rank() == 3};
}

}  // namespace rfmvo
