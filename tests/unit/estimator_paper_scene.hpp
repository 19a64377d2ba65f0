// A handmade world for the tests of the paper's estimator: antennas, a path, tags, and the phases that
// geometry gives. Uses the product's data types but none of its phase or geometry formulas.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "estimator/antenna_array.hpp"

namespace paper_scene {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kWavelength_m = 0.325;  // 922.4 MHz

// Even, repeatable noise in [-1, 1], without a random generator: the fractional parts of multiples of the
// golden ratio.
inline double wobble(int i) { return 2.0 * std::fmod(0.6180339887498949 * (i + 1), 1.0) - 1.0; }

inline double phase_rad(double distance_m, double offset_rad) {
  const double turns = 2.0 * distance_m / kWavelength_m + offset_rad / (2.0 * kPi);
  return 2.0 * kPi * (turns - std::floor(turns));
}

// An array along `path_m` (true positions of the camera), seen by VO at 1/gamma, no lever arm.
inline rfmvo::AntennaArray array_of(const std::vector<Eigen::Vector3d>& path_m, const std::vector<double>& phases_rad,
                                    double gamma) {
  const auto n = static_cast<Eigen::Index>(path_m.size());
  rfmvo::AntennaArray array;
  array.camera_V.resize(3, n);
  array.lever_V_m = Eigen::Matrix3Xd::Zero(3, n);
  array.phase_step_rad.resize(n - 1);
  array.duration_s = Eigen::VectorXd::Constant(n - 1, 0.1);
  array.usable.setConstant(n - 1, true);
  array.wavelength_m = kWavelength_m;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    array.camera_V.col(i) = (path_m[k] - path_m[0]) / gamma;
    if (i > 0) array.phase_step_rad(i - 1) = phases_rad[k] - phases_rad[k - 1];
  }
  return array;
}

// Plane wave from direction u (unit, towards the tag): distance = - p.u.
inline std::vector<double> plane_phases(const std::vector<Eigen::Vector3d>& path_m, const Eigen::Vector3d& u,
                                        double offset_rad) {
  std::vector<double> phases;
  for (const auto& p : path_m) phases.push_back(phase_rad(100.0 - p.dot(u), offset_rad));
  return phases;
}

inline std::vector<double> tag_phases(const std::vector<Eigen::Vector3d>& path_m, const Eigen::Vector3d& tag_m,
                                      double offset_rad) {
  std::vector<double> phases;
  for (const auto& p : path_m) phases.push_back(phase_rad((tag_m - p).norm(), offset_rad));
  return phases;
}

// Steps of about 5 cm (below lambda/4) along x with a weave in y and, times `vertical`, in z.
inline std::vector<Eigen::Vector3d> weave(int elements, double vertical) {
  std::vector<Eigen::Vector3d> path;
  for (int i = 0; i < elements; ++i) {
    const double s = 0.04 * i;
    path.emplace_back(s, 0.12 * std::sin(3.1 * s), vertical * 0.12 * std::sin(4.3 * s + 0.5));
  }
  return path;
}

}  // namespace paper_scene
