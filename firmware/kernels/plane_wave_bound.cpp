#include "kernels/plane_wave_bound.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace rfmvo {
namespace {

using Vector = std::array<double, 3>;
using Form = std::array<double, 6>;  // quadratic: xx, yy, zz, xy, xz, yz

Vector wavenumber(const PlaneWaveStep& step) {
  const auto& c = step.camera_turns;
  return {kTwoPi * double{c[0]}, kTwoPi * double{c[1]}, kTwoPi * double{c[2]}};
}

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void add_square(Form& form, const Vector& v, double weight) {
  const double x = weight * v[0], y = weight * v[1], z = weight * v[2];
  form[0] += x * v[0];
  form[1] += y * v[1];
  form[2] += z * v[2];
  form[3] += x * v[1];
  form[4] += x * v[2];
  form[5] += y * v[2];
}

double value(const Form& form, const Vector& v) {
  return form[0] * v[0] * v[0] + form[1] * v[1] * v[1] + form[2] * v[2] * v[2] +
         2.0 * (form[3] * v[0] * v[1] + form[4] * v[0] * v[2] + form[5] * v[1] * v[2]);
}

}  // namespace

PlaneWaveCurvature curvature_of(std::span<const PlaneWaveStep> steps) {
  PlaneWaveCurvature c;
  const double mean = 1.0 / static_cast<double>(steps.size());
  for (const PlaneWaveStep& step : steps) {
    const Vector k = wavenumber(step);
    add_square(c.mean_square, k, mean);
    c.longest = std::max(c.longest, std::sqrt(dot(k, k)));
  }
  return c;
}

PlaneWaveBound::PlaneWaveBound(std::span<const PlaneWaveStep> steps, const PlaneWaveCurvature& curvature,
                               const Vector& centre)
    : curvature_(curvature), centre_(centre) {
  const double mean = 1.0 / static_cast<double>(steps.size());
  for (const PlaneWaveStep& step : steps) {
    const Vector k = wavenumber(step);
    const double turns = step.phase_step_q16 / kBinaryAnglesPerTurn + dot(k, centre) / kTwoPi;
    // Truncated: the code stands for its middle.
    const double code = std::floor((turns - std::floor(turns)) * kBinaryAnglesPerTurn);
    const auto angle = static_cast<std::uint16_t>(static_cast<std::int32_t>(code));
    const double c = mean * cosine_q15(angle) / kOne_q15, s = mean * sine_q15(angle) / kOne_q15;
    power_ += c;
    for (std::size_t axis = 0; axis < 3; ++axis) gradient_[axis] -= s * k[axis];
    add_square(half_hessian_, k, -0.5 * c);
  }
}

double PlaneWaveBound::at(double x, double y, double z) const {
  const Vector d{x - centre_[0], y - centre_[1], z - centre_[2]};
  const double reach = curvature_.longest * std::sqrt(dot(d, d));  // rad: not below any |k_i'D|
  const double taylor = power_ + dot(gradient_, d) + value(half_hessian_, d);
  const double remainder = reach * value(curvature_.mean_square, d) / 6.0;
  return taylor + remainder + kCosineMaxAbsError * (1.0 + reach * (1.0 + 0.5 * reach));
}

}  // namespace rfmvo
