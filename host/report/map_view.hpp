// How a map is looked at, and what of the page it takes.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "base/units.hpp"

namespace rfmvo::report {

// A parallel projection of W onto the page: ellipsoids become ellipses.
struct View {
  Eigen::Matrix<double, 2, 3> onto = Eigen::Matrix<double, 2, 3>::Identity();
  const char* name = "";
  const char* title = "";
  const char* right = "x (m)";  // what the page's axes are; empty: none of W
  const char* up = "y (m)";

  [[nodiscard]] Eigen::Vector2d operator()(const Eigen::Vector3d& p) const { return onto * p; }
};

inline Eigen::Matrix<double, 2, 3> axes(int right, int up) {
  Eigen::Matrix<double, 2, 3> onto = Eigen::Matrix<double, 2, 3>::Zero();
  onto(0, right) = onto(1, up) = 1.0;
  return onto;
}

// From behind, to the right and above: x goes right and up, y left and up, z up.
inline Eigen::Matrix<double, 2, 3> oblique() {
  const double turn = rad_from_deg(35.0), tilt = rad_from_deg(30.0);
  Eigen::Matrix<double, 2, 3> onto;
  onto << std::cos(turn), -std::sin(turn), 0.0, std::sin(turn) * std::sin(tilt), std::cos(turn) * std::sin(tilt),
      std::cos(tilt);
  return onto;
}

struct Box {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300), high = Eigen::Vector2d::Constant(-1e300);

  void add(const Eigen::Vector2d& p) {
    if (!p.allFinite()) return;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  [[nodiscard]] bool empty() const { return low.x() > high.x(); }
};

}  // namespace rfmvo::report
