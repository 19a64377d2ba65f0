// Eq. (1), (6) and the spherical twin of Eq. (6) as they stand in the paper and in docs/estimator.md,
// in double precision. Shares no code with the product.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace rfmvo::reference {

inline constexpr double kTwoPi = 6.283185307179586476925;
using Point = std::array<double, 3>;

[[nodiscard]] double distance(const Point& a, const Point& b);

struct SphericalRead {
  Point antenna_m{};
  double turns_per_m = 0.0;
  double phase_rad = 0.0;
  int group = 0;
};

// Sum over groups of |sum of exp j(phase - 2 pi turns_per_m distance)|^2 / reads of the group.
[[nodiscard]] double power(std::span<const SphericalRead> reads, const Point& place_m);

// One pair of consecutive reads of an antenna array.
struct PlaneStep {
  Point camera{};               // Delta X_C, unit of V
  double phase_step_rad = 0.0;  // Delta phi
};

// Eq. (6) with Delta X_A = gamma * Delta X_C.
[[nodiscard]] double spatial_power(std::span<const PlaneStep> steps, double wavelength_m, double alpha_rad,
                                   double beta_rad, double gamma);

// The same with a unit vector for the angles, and 4 pi / lambda * gamma in one.
[[nodiscard]] double spatial_power_along(std::span<const PlaneStep> steps, const Point& direction, double rad_per_unit);

}  // namespace rfmvo::reference
