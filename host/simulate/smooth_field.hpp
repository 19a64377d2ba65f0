// A zero-mean, unit-variance Gaussian process along an antenna's travel: the shape of structured phase
// error and of fading.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "simulate/scene.hpp"

namespace rfmvo::simulate {

// Correlation exp(-ds^2 / (2 l^2)). Against the values measured on real R420 data, 0.94 / 0.85 / 0.61 /
// 0.37 / 0.16 / 0 at 2 / 4 / 8 / 12 / 16 / 20 cm, the rms misfit of valid (positive definite) kernels is
//   Gaussian, l = 8 cm               0.033   <- chosen: also the only one that is nearly 0 at 20 cm
//   Matern 5/2, zero slope, 9.4 cm   0.058
//   Matern 3/2, 5.84 cm              0.069
inline constexpr double kStructuredLength_m = 0.08;

class SmoothField {
 public:
  // Defined on [0, length_m] of arc length.
  SmoothField(double length_m, double correlation_length_m, std::uint64_t seed, std::string_view purpose,
              std::uint64_t index);
  [[nodiscard]] double at(double arc_m) const;

 private:
  std::vector<double> grid_;
  double step_m_;
};

// Length of the way that a point fixed to the camera has travelled since the scene's start.
class ArcLength {
 public:
  ArcLength(const Scene& scene, const Eigen::Vector3d& p_C_m);
  [[nodiscard]] double at(double t_s) const;
  [[nodiscard]] double total() const { return arc_m_.back(); }

 private:
  double start_s_;
  std::vector<double> arc_m_;
};

}  // namespace rfmvo::simulate
