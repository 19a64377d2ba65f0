// Stage 2, spatial power spectrum search (paper section III.A): Eq. (1), (3)-(6), (8), (16).
// Plane waves: the tag's direction is the same for all elements of an array.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "estimator/antenna_array.hpp"
#include "estimator/array_spectrum.hpp"
#include "estimator/incident_angles.hpp"

namespace rfmvo {

// Eq. (3), (21): the multiple of 2 pi that brings a phase difference in [-2 pi, 2 pi] to [-pi, pi].
[[nodiscard]] double cycle_step_rad(double phase_step_rad);

// Limits of gamma, metres per unit of V. Empty where noise or missed reads push them past each other.
struct ScaleRange {
  double min = 0.0;
  double max = 0.0;
  [[nodiscard]] bool empty() const { return !(min < max); }
};

struct ScaleLimits {
  double max_speed_m_s = 1.0;      // of the cart
  double min_read_rate_hz = 10.0;  // of the tag, Eq. (5)
  bool fixed = false;              // the repaired limits, see scale_range
};

// Eq. (4), (5), over all antennas. With `fixed`: limits on the whole path instead of the worst step
// (docs/paper.md, fix_scale_range).
[[nodiscard]] ScaleRange scale_range(std::span<const AntennaArray> arrays, const ScaleLimits& limits);

// Eq. (6): P_k(alpha, beta, gamma) of one antenna, in [-1, 1]; 0 if no step is usable.
[[nodiscard]] double spatial_power(const AntennaArray& array, const IncidentAngles& angles, double gamma);

struct SpectrumPeak {
  bool found = false;                  // false: empty scale range, or an array without usable steps
  double gamma = 0.0;                  // gamma*, metres per unit of V
  double power = 0.0;                  // mean over the antennas of S_k at gamma*
  std::vector<IncidentAngles> angles;  // (alpha*, beta*), one per antenna
};

// Eq. (8). angle_step_rad: delta alpha = delta beta. relative_scale_step: delta gamma as a fraction of
// the middle of the range. Differs from section VII (delta gamma = 0.1), because the unit of V is
// arbitrary: the same path in another unit must give the same grid in metres.
[[nodiscard]] SpectrumPeak search_spectrum(std::span<const AntennaArray> arrays, const ScaleRange& range,
                                           double angle_step_rad, double relative_scale_step);

// Eq. (16) of one array, for as many angles and scales as it is asked about.
class AngleRefinement {
 public:
  AngleRefinement(const AntennaArray& array, double step_rad, double range_rad);
  // The best angles within +- range of the given ones, gamma held.
  [[nodiscard]] IncidentAngles best(const IncidentAngles& around, double gamma);

 private:
  ArraySpectrum spectrum_;
  double step_rad_, range_rad_;
  IncidentAngles middle_;              // of the grid
  std::optional<DirectionGrid> grid_;  // kept: near convergence the angles stay
};

// The same, once.
[[nodiscard]] IncidentAngles refine_angles(const AntennaArray& array, const IncidentAngles& around, double gamma,
                                           double step_rad, double range_rad);

}  // namespace rfmvo
