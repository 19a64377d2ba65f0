// The paper's Eq. (6), (8) and (28) once more, in plain loops, straight from its text. Shares no code
// with firmware/: neither types nor constants nor algorithms. Radians, metres.
#pragma once

#include <array>
#include <vector>

namespace paper_reference {

using Point = std::array<double, 3>;

struct Antenna {
  std::vector<double> phase;  // phi_A[k, 1..L]
  std::vector<Point> camera;  // X_C[k, 1..L], units of V
  double wavelength = 0.0;
};

double spatial_power(const Antenna& antenna, double alpha, double beta, double gamma);  // Eq. (6)

struct Peak {
  double gamma = 0.0, mean_power = 0.0;
  std::vector<double> alpha, beta;  // one per antenna
};
// Eq. (8) on the grids alpha, beta = 0, step, ..., pi and the given scales.
Peak search(const std::vector<Antenna>& antennas, double angle_step, const std::vector<double>& gammas);

double hdop(const std::vector<Point>& antennas, const Point& tag);  // Eq. (28); horizontal = x, y

}  // namespace paper_reference
