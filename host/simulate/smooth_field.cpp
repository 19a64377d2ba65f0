#include "simulate/smooth_field.hpp"

#include <algorithm>
#include <cmath>

#include "simulate/random.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kGridPerLength =
    8.0;  // grid steps per correlation length: linear interpolation loses < 0.4 % of the variance
constexpr double kKernelLengths = 3.0;  // the kernel is cut where it is exp(-9)
constexpr double kArcStep_s = 0.005;    // 5 mm at 1 m/s; a straight chord there is exact enough

// Linear interpolation in a table over x = 0, 1, ..., clamped at its ends.
double interpolate_table(const std::vector<double>& table, double x) {
  const double clamped = std::clamp(x, 0.0, static_cast<double>(table.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(clamped), table.size() - 2);
  const double f = clamped - static_cast<double>(i);
  return (1.0 - f) * table[i] + f * table[i + 1];
}

}  // namespace

// White noise filtered with exp(-s^2 / l^2): the filter's autocorrelation is exp(-s^2 / (2 l^2)).
SmoothField::SmoothField(double length_m, double correlation_length_m, std::uint64_t seed, std::string_view purpose,
                         std::uint64_t index)
    : step_m_(correlation_length_m / kGridPerLength) {
  const int half = static_cast<int>(kKernelLengths * kGridPerLength);
  std::vector<double> kernel;
  double energy = 0.0;
  for (int i = -half; i <= half; ++i) {
    const double lengths = i / kGridPerLength;
    kernel.push_back(std::exp(-lengths * lengths));
    energy += kernel.back() * kernel.back();
  }
  const std::size_t points = static_cast<std::size_t>(std::ceil(length_m / step_m_)) + 2;
  Random random(seed, purpose, index);
  std::vector<double> white(points + kernel.size() - 1);
  for (double& w : white) w = random.normal();
  grid_.resize(points);
  for (std::size_t i = 0; i < points; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < kernel.size(); ++j) sum += kernel[j] * white[i + j];
    grid_[i] = sum / std::sqrt(energy);
  }
}

double SmoothField::at(double arc_m) const { return interpolate_table(grid_, arc_m / step_m_); }

ArcLength::ArcLength(const Scene& scene, const Eigen::Vector3d& p_C_m) : start_s_(scene.start_s()), arc_m_{0.0} {
  Eigen::Vector3d last = scene.T_S_C(start_s_) * p_C_m;
  const int steps = static_cast<int>(std::ceil((scene.end_s() - start_s_) / kArcStep_s)) + 1;
  for (int k = 1; k <= steps; ++k) {
    const Eigen::Vector3d p = scene.T_S_C(start_s_ + k * kArcStep_s) * p_C_m;
    arc_m_.push_back(arc_m_.back() + (p - last).norm());
    last = p;
  }
}

double ArcLength::at(double t_s) const { return interpolate_table(arc_m_, (t_s - start_s_) / kArcStep_s); }

}  // namespace rfmvo::simulate
