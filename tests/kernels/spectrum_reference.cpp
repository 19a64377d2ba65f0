#include "kernels/spectrum_reference.hpp"

#include <cmath>
#include <complex>
#include <map>

namespace rfmvo::reference {

double distance(const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

double power(std::span<const SphericalRead> reads, const Point& place_m) {
  std::map<int, std::complex<double>> sums;
  std::map<int, int> counts;
  for (const SphericalRead& read : reads) {
    const double phase_rad = read.phase_rad - kTwoPi * read.turns_per_m * distance(read.antenna_m, place_m);
    sums[read.group] += std::polar(1.0, phase_rad);
    counts[read.group] += 1;
  }
  double power = 0.0;
  for (const auto& [group, sum] : sums) power += std::norm(sum) / counts[group];
  return power;
}

double spatial_power(std::span<const PlaneStep> steps, double wavelength_m, double alpha_rad, double beta_rad,
                     double gamma) {
  double sum = 0.0;
  for (const PlaneStep& step : steps) {
    const double dh = gamma * (step.camera[0] * std::cos(alpha_rad) * std::cos(beta_rad) +
                               step.camera[1] * std::sin(alpha_rad) * std::cos(beta_rad) +
                               step.camera[2] * std::sin(beta_rad));          // Eq. (1)
    sum += std::cos(step.phase_step_rad + 2.0 * kTwoPi / wavelength_m * dh);  // Eq. (6): 4 pi / lambda
  }
  return sum / static_cast<double>(steps.size());
}

double spatial_power_along(std::span<const PlaneStep> steps, const Point& u, double rad_per_unit) {
  double sum = 0.0;
  for (const PlaneStep& step : steps) {
    const double along = step.camera[0] * u[0] + step.camera[1] * u[1] + step.camera[2] * u[2];
    sum += std::cos(step.phase_step_rad + rad_per_unit * along);
  }
  return sum / static_cast<double>(steps.size());
}

}  // namespace rfmvo::reference
