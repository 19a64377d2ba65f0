#include "estimator/spatial_power_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/assert.hpp"
#include "base/units.hpp"

namespace rfmvo {
namespace {

constexpr double kMinCameraStep = 1e-9;  // units of V: a shorter step says nothing about the scale
// What noise and multipath can add to one phase difference: 0.3 rad of structured error between two
// reads (docs/paper.md) plus reader noise.
constexpr double kPhaseStepAllowance_rad = 0.5;
constexpr double kMinScaleFraction = 0.02;  // of the upper limit: the search needs a positive start

// Eq. (4) and (5) of one array, folded into the range so far.
void narrow_by_steps(const AntennaArray& array, double max_step_m, ScaleRange& range) {
  for (Eigen::Index i = 0; i < array.steps(); ++i) {
    const double camera_step = array.camera_step(i);
    if (camera_step < kMinCameraStep) continue;
    range.max = std::min(range.max, max_step_m / camera_step);  // Eq. (5)
    if (!array.usable(i)) continue;
    const double phase = array.phase_step_rad(i) + cycle_step_rad(array.phase_step_rad(i));
    const double distance_step_m = array.wavelength_m / (2.0 * kTwoPi) * phase;  // Eq. (2)
    range.min = std::max(range.min, distance_step_m / camera_step);              // Eq. (4)
  }
}

// 0, step, 2 step, ... up to `end`.
std::vector<double> multiples(double step, double end) {
  std::vector<double> values;
  const int count = static_cast<int>(std::floor(end / step + 1e-9));
  for (int n = 0; n <= count; ++n) values.push_back(n * step);
  return values;
}

// middle +- range by steps, within [0, pi].
std::vector<double> window(double middle_rad, double step_rad, double range_rad) {
  std::vector<double> angles;
  const int count = static_cast<int>(std::floor(range_rad / step_rad + 1e-9));
  for (int n = -count; n <= count; ++n) {
    const double angle = middle_rad + n * step_rad;
    if (angle >= -1e-9 && angle <= kPi + 1e-9) angles.push_back(angle);
  }
  return angles;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Differs from Eq. (4), (5): limits on sums and medians over the array, because one missed read (long
// step) or one noisy read (short step) pushes the limit of a single step past the truth. The speed limit
// holds for the mean speed, the median step is at most lambda/2 as Eq. (20) demands, and an unwrapped
// |Delta d| is never too long by more than the allowance.
void narrow_by_path(const AntennaArray& array, double max_speed_m_s, ScaleRange& range) {
  double path = 0.0, usable_path = 0.0, radial_m = 0.0;
  std::vector<double> camera_steps;
  for (Eigen::Index i = 0; i < array.steps(); ++i) {
    camera_steps.push_back(array.camera_step(i));
    path += camera_steps.back();
    if (!array.usable(i)) continue;
    const double phase = array.phase_step_rad(i) + cycle_step_rad(array.phase_step_rad(i));
    usable_path += camera_steps.back();
    radial_m += array.wavelength_m / (2.0 * kTwoPi) * std::max(0.0, std::abs(phase) - kPhaseStepAllowance_rad);
  }
  const double middle_step = median(std::move(camera_steps));
  if (middle_step > kMinCameraStep) range.max = std::min(range.max, 0.5 * array.wavelength_m / middle_step);
  if (path > kMinCameraStep) range.max = std::min(range.max, max_speed_m_s * array.duration_s.sum() / path);
  if (usable_path > kMinCameraStep) range.min = std::max(range.min, radial_m / usable_path);
}

}  // namespace

double cycle_step_rad(double phase_step_rad) {
  if (phase_step_rad < -kPi) return kTwoPi;
  if (phase_step_rad > kPi) return -kTwoPi;
  return 0.0;
}

ScaleRange scale_range(std::span<const AntennaArray> arrays, const ScaleLimits& limits) {
  ScaleRange range{0.0, std::numeric_limits<double>::max()};
  for (const AntennaArray& array : arrays) {
    if (limits.fixed) {
      narrow_by_path(array, limits.max_speed_m_s, range);
    } else {
      narrow_by_steps(array, limits.max_speed_m_s / limits.min_read_rate_hz, range);
    }
  }
  if (range.max == std::numeric_limits<double>::max()) return {};  // the camera never moved
  range.min = std::max(range.min, kMinScaleFraction * range.max);
  return range;
}

double spatial_power(const AntennaArray& array, const IncidentAngles& angles, double gamma) {
  ArraySpectrum spectrum(array);
  return spectrum.empty() ? 0.0 : spectrum.power(angles, gamma);  // Eq. (6)
}

SpectrumPeak search_spectrum(std::span<const AntennaArray> arrays, const ScaleRange& range, double angle_step_rad,
                             double relative_scale_step) {
  RFMVO_ASSERT(angle_step_rad > 0.0 && relative_scale_step > 0.0);
  SpectrumPeak peak;
  if (arrays.empty() || range.empty()) return peak;
  const double step = relative_scale_step * 0.5 * (range.min + range.max);
  const GammaSteps scales{range.min, step, static_cast<int>(std::floor((range.max - range.min) / step + 1e-9)) + 1};
  const std::vector<double> half_turn = multiples(angle_step_rad, kPi);
  const DirectionGrid grid(half_turn, half_turn);
  Eigen::ArrayXd mean_power = Eigen::ArrayXd::Zero(scales.count);
  std::vector<std::vector<GridPeak>> peaks;
  for (const AntennaArray& array : arrays) {
    ArraySpectrum spectrum(array);
    if (spectrum.empty()) return peak;
    peaks.push_back(spectrum.peaks(grid, scales));  // Eq. (8), line 1
    for (int n = 0; n < scales.count; ++n)
      mean_power(n) += peaks.back()[static_cast<std::size_t>(n)].power / static_cast<double>(arrays.size());
  }
  Eigen::Index at = 0;
  peak.power = mean_power.maxCoeff(&at);  // Eq. (8), line 2; the smallest gamma of equals
  peak.gamma = scales.at(static_cast<int>(at));
  for (const auto& of_antenna : peaks)  // line 3
    peak.angles.push_back(grid.angles(of_antenna[static_cast<std::size_t>(at)].direction));
  peak.found = true;
  return peak;
}

AngleRefinement::AngleRefinement(const AntennaArray& array, double step_rad, double range_rad)
    : spectrum_(array), step_rad_(step_rad), range_rad_(range_rad) {}

IncidentAngles AngleRefinement::best(const IncidentAngles& around, double gamma) {
  if (spectrum_.empty()) return around;
  if (!grid_ || around.alpha_rad != middle_.alpha_rad || around.beta_rad != middle_.beta_rad) {
    middle_ = around;
    grid_.emplace(window(around.alpha_rad, step_rad_, range_rad_), window(around.beta_rad, step_rad_, range_rad_));
  }
  if (grid_->size() == 0) return around;
  return grid_->angles(spectrum_.peaks(*grid_, {gamma, 0.0, 1}).front().direction);
}

IncidentAngles refine_angles(const AntennaArray& array, const IncidentAngles& around, double gamma, double step_rad,
                             double range_rad) {
  return AngleRefinement(array, step_rad, range_rad).best(around, gamma);
}

}  // namespace rfmvo
