#include "reference/paper_reference.hpp"

#include <cmath>

namespace paper_reference {
namespace {
const double kPi = std::acos(-1.0);
}

double spatial_power(const Antenna& antenna, double alpha, double beta, double gamma) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < antenna.phase.size(); ++i) {
    const double dx = gamma * (antenna.camera[i + 1][0] - antenna.camera[i][0]);
    const double dy = gamma * (antenna.camera[i + 1][1] - antenna.camera[i][1]);
    const double dz = gamma * (antenna.camera[i + 1][2] - antenna.camera[i][2]);
    const double dh =
        dx * std::cos(alpha) * std::cos(beta) + dy * std::sin(alpha) * std::cos(beta) + dz * std::sin(beta);  // Eq. (1)
    const double dphi = antenna.phase[i + 1] - antenna.phase[i];
    sum += std::cos(dphi + 4.0 * kPi / antenna.wavelength * dh);
  }
  return sum / static_cast<double>(antenna.phase.size() - 1);
}

Peak search(const std::vector<Antenna>& antennas, double angle_step, const std::vector<double>& gammas) {
  const int count = static_cast<int>(kPi / angle_step + 1e-9);
  Peak peak;
  peak.mean_power = -2.0;
  for (const double gamma : gammas) {
    Peak here;
    here.gamma = gamma;
    for (const Antenna& antenna : antennas) {
      double best = -2.0, best_alpha = 0.0, best_beta = 0.0;
      for (int a = 0; a <= count; ++a)
        for (int b = 0; b <= count; ++b) {
          const double power = spatial_power(antenna, a * angle_step, b * angle_step, gamma);
          if (power > best) {
            best = power;
            best_alpha = a * angle_step;
            best_beta = b * angle_step;
          }
        }
      here.mean_power += best / static_cast<double>(antennas.size());
      here.alpha.push_back(best_alpha);
      here.beta.push_back(best_beta);
    }
    if (here.mean_power > peak.mean_power) peak = here;
  }
  return peak;
}

double hdop(const std::vector<Point>& antennas, const Point& tag) {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Point& a : antennas) {
    const double x = tag[0] - a[0], y = tag[1] - a[1], z = tag[2] - a[2];
    const double d = std::sqrt(x * x + y * y + z * z);
    xx += x / d * x / d;
    xy += x / d * y / d;
    yy += y / d * y / d;
  }
  return std::sqrt((xx + yy) / (xx * yy - xy * xy));  // trace of the inverse of a 2 x 2 matrix
}

}  // namespace paper_reference
