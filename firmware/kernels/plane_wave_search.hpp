// Search of Eq. (8): the scale whose spectra's peaks over the directions are highest on average over the antennas,
// and those peaks. The full grid, and a search that provably finds the same cell with fewer terms.
//
// Proof. With k_i = 2 pi camera_i, w = gamma u and D = w - w0, every term is cos(theta_i + k_i'D), and Taylor's
// theorem with |cos'''| <= 1 (the Lipschitz constant of cos'') gives
//   P(w) <= P(w0) + g'D + D'HD / 2 + mean |k_i'D|^3 / 6,   mean |k_i'D|^3 <= max|k_i| |D| D'MD,
//   g = -mean k_i sin theta_i,   H = -mean k_i k_i' cos theta_i,   M = mean k_i k_i'.
// Sines and cosines from binary_angle.hpp add e (1 + max|k_i| |D| + (max|k_i| |D|)^2 / 2), e = kCosineMaxAbsError, and
// the kernel's P is within max_abs_error of the exact one. A cell whose bound is below a power that was
// already found is not the best and need not be evaluated; a scale whose mean bound is below a mean found, neither.
// Ties: the smallest scale, then the smallest direction, as on the full grid.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/plane_wave_spectrum.hpp"

namespace rfmvo {

// alpha and beta from 0 to 180 degrees, `count` values each; direction alpha * count + beta.
class AngleGrid {
 public:
  explicit AngleGrid(int count);

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] std::size_t size() const { return x_.size(); }
  [[nodiscard]] Directions directions() const { return {x_, y_, z_}; }

 private:
  int count_;
  std::vector<float> x_, y_, z_;
};

struct SpectrumMaximum {
  int scale = 0;
  std::vector<int> directions;  // one per antenna
  double power = 0.0;           // mean over the antennas
  std::int64_t terms = 0;       // cosines and sines that were evaluated
  bool operator==(const SpectrumMaximum& o) const {
    return scale == o.scale && directions == o.directions && power == o.power;
  }
};

// One antenna's steps. Levers are zero: Eq. (1).
using PlaneWaveSteps = std::vector<PlaneWaveStep>;

[[nodiscard]] SpectrumMaximum search_full_grid(std::span<const PlaneWaveSteps> antennas, const ScaleSteps& scales,
                                               const AngleGrid& grid);

[[nodiscard]] SpectrumMaximum search_bounded(std::span<const PlaneWaveSteps> antennas, const ScaleSteps& scales,
                                             const AngleGrid& grid);

}  // namespace rfmvo
