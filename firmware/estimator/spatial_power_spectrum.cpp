#include "estimator/spatial_power_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/assert.hpp"
#include "base/units.hpp"

namespace rfmvo {
namespace {

using Eigen::ArrayXd;

constexpr double kMinCameraStep = 1e-9;  // units of V: a shorter step says nothing about the scale
// What noise and multipath can add to one phase difference: 0.3 rad of structured error between two
// reads (docs/paper.md) plus reader noise.
constexpr double kPhaseStepAllowance_rad = 0.5;
constexpr double kMinScaleFraction = 0.02;  // of the upper limit: the search needs a positive start

// cos(2 pi t), elementwise, in plain arithmetic that the compiler's vector units run; error < 1e-11.
// One Taylor polynomial of the sine on a quarter turn, since cos(2 x) = 1 - 2 sin(x)^2.
// y is scratch of the same size.
void cosine_of_turns(ArrayXd& t, ArrayXd& y) {
  constexpr double kRound = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
  t = (t - ((t + kRound) - kRound)) * kPi;       // in [-pi/2, pi/2]
  y = t * t;
  t *= 1.0 +
       y * (-1.0 / 6 +
            y * (1.0 / 120 +
                 y * (-1.0 / 5040 + y * (1.0 / 362880 + y * (-1.0 / 39916800 + y * (1.0 / 6227020800.0 +
                                                                                    y * (-1.0 / 1307674368000.0)))))));
  t = 1.0 - 2.0 * t * t;
}

// The usable steps of an array in turns, as functions of the direction u (in D):
//   theta / (2 pi) = phase + (lever + gamma * camera)' u,  theta of Eq. (6), Delta h of Eq. (1).
struct Steps {
  ArrayXd phase;                                   // Delta phi
  Eigen::Array<double, Eigen::Dynamic, 3> lever;   // 2 / lambda * step of the lever arm (0 without fix_rotation)
  Eigen::Array<double, Eigen::Dynamic, 3> camera;  // 2 / lambda * step of the camera, per unit of gamma
};

Steps steps_of(const AntennaArray& array) {
  const Eigen::Index n = array.usable.count();
  Steps steps{ArrayXd(n), {n, 3}, {n, 3}};
  const Eigen::Matrix3d R_D_V = array.R_V_D.conjugate().toRotationMatrix();
  const double turns_per_m = 2.0 / array.wavelength_m;  // 4 pi / lambda, in turns
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < array.steps(); ++i) {
    if (!array.usable(i)) continue;
    steps.phase(row) = array.phase_step_rad(i) / kTwoPi;
    steps.lever.row(row) = turns_per_m * (R_D_V * (array.lever_V_m.col(i + 1) - array.lever_V_m.col(i))).transpose();
    steps.camera.row(row) = turns_per_m * (R_D_V * (array.camera_V.col(i + 1) - array.camera_V.col(i))).transpose();
    ++row;
  }
  return steps;
}

auto along(const Eigen::Array<double, Eigen::Dynamic, 3>& columns, const Eigen::Vector3d& u) {
  return columns.col(0) * u.x() + columns.col(1) * u.y() + columns.col(2) * u.z();
}

// Buffers of one search, so that its inner loops allocate nothing.
struct Scratch {
  explicit Scratch(Eigen::Index n) : slope(n), before(n), now(n), twice_cos(n), square(n) {}
  ArrayXd slope, before, now, twice_cos, square;
};

// Eq. (6) for gamma = first + n * step, n = 0, 1, ...: cos(a + n d) by its three-term recurrence.
void power_over_scales(const Steps& steps, const Eigen::Vector3d& u, double first, double step, Scratch& s,
                       ArrayXd& power) {
  s.slope = along(steps.camera, u);
  s.before = steps.phase + along(steps.lever, u) + first * s.slope;
  s.now = s.before + step * s.slope;
  s.twice_cos = step * s.slope;
  cosine_of_turns(s.before, s.square);
  cosine_of_turns(s.now, s.square);
  cosine_of_turns(s.twice_cos, s.square);
  s.twice_cos *= 2.0;
  power(0) = s.before.sum();
  for (Eigen::Index n = 1; n < power.size(); ++n) {
    power(n) = s.now.sum();
    s.before = s.twice_cos * s.now - s.before;
    s.before.swap(s.now);
  }
  power /= static_cast<double>(steps.phase.size());
}

struct BestAngles {
  ArrayXd power;  // S_k per scale
  std::vector<IncidentAngles> angles;
};

BestAngles best_angles(const Steps& steps, double first, double step, Eigen::Index scales, double angle_step_rad) {
  BestAngles best{ArrayXd::Constant(scales, -2.0), std::vector<IncidentAngles>(static_cast<std::size_t>(scales))};
  ArrayXd power(scales);
  Scratch scratch(steps.phase.size());
  const int count = static_cast<int>(std::floor(kPi / angle_step_rad + 1e-9));
  for (int a = 0; a <= count; ++a) {
    for (int b = 0; b <= count; ++b) {
      const IncidentAngles angles{a * angle_step_rad, b * angle_step_rad};
      power_over_scales(steps, direction_of(angles), first, step, scratch, power);
      for (Eigen::Index n = 0; n < scales; ++n) {
        if (power(n) <= best.power(n)) continue;
        best.power(n) = power(n);
        best.angles[static_cast<std::size_t>(n)] = angles;
      }
    }
  }
  return best;
}

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
  const Steps steps = steps_of(array);
  if (steps.phase.size() == 0) return 0.0;
  const Eigen::Vector3d u = direction_of(angles);
  ArrayXd turns = steps.phase + along(steps.lever, u) + gamma * along(steps.camera, u);
  ArrayXd square(turns.size());
  cosine_of_turns(turns, square);
  return turns.mean();  // Eq. (6)
}

SpectrumPeak search_spectrum(std::span<const AntennaArray> arrays, const ScaleRange& range, double angle_step_rad,
                             double relative_scale_step) {
  RFMVO_ASSERT(angle_step_rad > 0.0 && relative_scale_step > 0.0);
  SpectrumPeak peak;
  if (arrays.empty() || range.empty()) return peak;
  const double step = relative_scale_step * 0.5 * (range.min + range.max);
  const auto scales = static_cast<Eigen::Index>(std::floor((range.max - range.min) / step + 1e-9)) + 1;
  ArrayXd mean_power = ArrayXd::Zero(scales);
  std::vector<BestAngles> best;
  for (const AntennaArray& array : arrays) {
    const Steps steps = steps_of(array);
    if (steps.phase.size() == 0) return peak;
    best.push_back(best_angles(steps, range.min, step, scales, angle_step_rad));  // Eq. (8), line 1
    mean_power += best.back().power / static_cast<double>(arrays.size());
  }
  Eigen::Index at = 0;
  peak.power = mean_power.maxCoeff(&at);  // Eq. (8), line 2; the smallest gamma of equals
  peak.gamma = range.min + step * static_cast<double>(at);
  for (const BestAngles& b : best) peak.angles.push_back(b.angles[static_cast<std::size_t>(at)]);  // line 3
  peak.found = true;
  return peak;
}

IncidentAngles refine_angles(const AntennaArray& array, const IncidentAngles& around, double gamma, double step_rad,
                             double range_rad) {
  const Steps steps = steps_of(array);
  if (steps.phase.size() == 0) return around;
  const Eigen::Array<double, Eigen::Dynamic, 3> slope = steps.lever + gamma * steps.camera;
  const int count = static_cast<int>(std::floor(range_rad / step_rad + 1e-9));
  const auto inside = [](double angle) { return angle >= -1e-9 && angle <= kPi + 1e-9; };
  IncidentAngles best = around;
  double best_power = -static_cast<double>(array.steps()) - 1.0;
  ArrayXd level(steps.phase.size()), turns(steps.phase.size()), square(steps.phase.size());
  for (int a = -count; a <= count; ++a) {
    const double alpha = around.alpha_rad + a * step_rad;
    if (!inside(alpha)) continue;
    level = std::cos(alpha) * slope.col(0) + std::sin(alpha) * slope.col(1);
    for (int b = -count; b <= count; ++b) {
      const double beta = around.beta_rad + b * step_rad;
      if (!inside(beta)) continue;
      turns = steps.phase + std::cos(beta) * level + std::sin(beta) * slope.col(2);
      cosine_of_turns(turns, square);
      const double power = turns.sum();
      if (power <= best_power) continue;
      best_power = power;
      best = {alpha, beta};
    }
  }
  return best;
}

}  // namespace rfmvo
