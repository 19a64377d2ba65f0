// The shape of a cloud of antenna places: whether it is a line, a plane or fills space decides which positions of a
// tag the phases cannot tell apart.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rfmvo {

struct PrincipalAxes {
  // Places nearer to a line than this (standard deviation across it) are one: a quarter wavelength, a spread that
  // turns phases by less than pi at the ends.
  static constexpr double kLine_m = 0.08;

  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns: direction of least spread first
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Zero();   // along them, rising

  [[nodiscard]] bool is_line() const { return sigma_m[1] < kLine_m; }
  [[nodiscard]] Eigen::Vector3d line() const { return axes.col(2); }
  [[nodiscard]] Eigen::Vector3d normal() const { return axes.col(0); }
};

[[nodiscard]] PrincipalAxes principal_axes(const std::vector<Eigen::Vector3d>& places);

}  // namespace rfmvo
