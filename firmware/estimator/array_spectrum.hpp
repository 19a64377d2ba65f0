// The spatial power spectrum of one antenna array, Eq. (6), and its peaks on a grid of directions.
//
// The fixed-point kernel sifts the grid, double decides. The kernel's power is within max_abs_error of the one that its
// steps stand for. Beyond it: phases are rounded to half a code, pi / 65536 or 0.32 kCosineMaxAbsError, and directions
// to float, one rounding of the angle of the six that the bound counts. With e = 1.4 max_abs_error, a direction whose
// fixed-point power is more than 2 e below the best cannot be the peak. The few others are evaluated in double,
// so that the peak is that of the whole grid in double.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/antenna_array.hpp"
#include "estimator/incident_angles.hpp"
#include "kernels/plane_wave_spectrum.hpp"

namespace rfmvo {

// Every azimuth with every elevation; direction number = azimuth number * elevations + elevation number.
class DirectionGrid {
 public:
  DirectionGrid(std::vector<double> alpha_rad, std::vector<double> beta_rad);

  [[nodiscard]] std::size_t size() const { return x_.size(); }
  [[nodiscard]] IncidentAngles angles(std::size_t direction) const {
    return {alpha_rad_[direction / beta_rad_.size()], beta_rad_[direction % beta_rad_.size()]};
  }
  // direction_of(angles), without its sines and cosines.
  [[nodiscard]] Eigen::Vector3d unit_vector(std::size_t direction) const {
    const Sides &alpha = alpha_[direction / beta_.size()], &beta = beta_[direction % beta_.size()];
    return {alpha.cos * beta.cos, alpha.sin * beta.cos, beta.sin};
  }
  [[nodiscard]] Directions directions() const { return {x_, y_, z_}; }

 private:
  struct Sides {
    double cos, sin;
  };
  static std::vector<Sides> sides_of(const std::vector<double>& angles_rad);

  std::vector<double> alpha_rad_, beta_rad_;
  std::vector<Sides> alpha_, beta_;
  std::vector<float> x_, y_, z_;
};

// gamma = first + n * step, 0 <= n < count; metres per unit of V.
struct GammaSteps {
  double first = 0.0, step = 0.0;
  int count = 1;
  [[nodiscard]] double at(int n) const { return first + n * step; }
};

struct GridPeak {
  double power = -2.0;        // P, in [-1, 1]
  std::size_t direction = 0;  // the first of equals
};

class ArraySpectrum {
 public:
  explicit ArraySpectrum(const AntennaArray& array);

  [[nodiscard]] bool empty() const { return phase_.size() == 0; }  // no step is usable
  // Eq. (6) in double; the array is not empty.
  [[nodiscard]] double power(const IncidentAngles& angles, double gamma);
  // Peak over the grid for every gamma; neither array nor grid is empty.
  [[nodiscard]] std::vector<GridPeak> peaks(const DirectionGrid& grid, const GammaSteps& scales);
  // The same without the kernel: what it is checked against, and for steps beyond the kernel's range.
  [[nodiscard]] std::vector<GridPeak> peaks_in_double(const DirectionGrid& grid, const GammaSteps& scales);

 private:
  [[nodiscard]] bool fits_kernel(const GammaSteps& scales) const;
  [[nodiscard]] std::vector<PlaneWaveStep> kernel_steps() const;
  void hold(double gamma) { slope_ = lever_ + gamma * camera_; }
  [[nodiscard]] double power_along(const Eigen::Vector3d& u);  // at the gamma held
  void raise(GridPeak& peak, const DirectionGrid& grid, std::size_t direction);

  using Rows = Eigen::Array<double, Eigen::Dynamic, 3>;
  Eigen::ArrayXd phase_;           // Delta phi of the usable steps, turns
  Rows lever_, camera_;            // 2 / lambda * steps in D: turns, and turns per unit of gamma
  Rows slope_;                     // lever + gamma * camera
  Eigen::ArrayXd turns_, square_;  // scratch
};

}  // namespace rfmvo
