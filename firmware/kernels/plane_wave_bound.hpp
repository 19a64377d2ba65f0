// An upper bound of the spectrum around a point, from its derivatives there: the proof is in plane_wave_search.hpp.
#pragma once

#include <array>
#include <span>

#include "kernels/plane_wave_spectrum.hpp"

namespace rfmvo {

// What all points share.
struct PlaneWaveCurvature {
  std::array<double, 6> mean_square{};  // M: xx, yy, zz, xy, xz, yz
  double longest = 0.0;                 // max |k_i|, rad
};

[[nodiscard]] PlaneWaveCurvature curvature_of(std::span<const PlaneWaveStep> steps);

class PlaneWaveBound {
 public:
  // 2 * steps.size() terms.
  PlaneWaveBound(std::span<const PlaneWaveStep> steps, const PlaneWaveCurvature& curvature,
                 const std::array<double, 3>& centre);

  // Not below P at w = gamma u.
  [[nodiscard]] double at(double x, double y, double z) const;

 private:
  PlaneWaveCurvature curvature_;
  std::array<double, 3> centre_;
  double power_ = 0.0;
  std::array<double, 3> gradient_{};
  std::array<double, 6> half_hessian_{};
};

}  // namespace rfmvo
