#include "estimator/array_spectrum.hpp"

#include <algorithm>
#include <cmath>

#include "base/assert.hpp"
#include "base/units.hpp"

namespace rfmvo {
namespace {

using Eigen::ArrayXd;

constexpr int kScalesAtATime = 64;  // bounds the memory of the sums
// The kernel asserts 127 and 15 turns; margins for its float.
constexpr double kMaxFirst_turns = 126.0, kMaxStep_turns = 14.0;

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

std::uint16_t phase_q16(double turns) {
  const double fraction = turns - std::floor(turns);
  return static_cast<std::uint16_t>(static_cast<std::uint32_t>(std::lround(fraction * kBinaryAnglesPerTurn)));
}

// Largest sum of the sizes of a row's components, as the kernel bounds its angles.
double longest(const Eigen::Array<double, Eigen::Dynamic, 3>& rows) { return rows.abs().rowwise().sum().maxCoeff(); }

}  // namespace

DirectionGrid::DirectionGrid(std::vector<double> alpha_rad, std::vector<double> beta_rad)
    : alpha_rad_(std::move(alpha_rad)),
      beta_rad_(std::move(beta_rad)),
      alpha_(sides_of(alpha_rad_)),
      beta_(sides_of(beta_rad_)) {
  const std::size_t size = alpha_.size() * beta_.size();
  for (std::vector<float>* axis : {&x_, &y_, &z_}) axis->resize(size);
  std::size_t n = 0;
  for (const Sides& a : alpha_) {  // Eq. (15)
    for (const Sides& b : beta_) {
      x_[n] = static_cast<float>(a.cos * b.cos);
      y_[n] = static_cast<float>(a.sin * b.cos);
      z_[n++] = static_cast<float>(b.sin);
    }
  }
}

std::vector<DirectionGrid::Sides> DirectionGrid::sides_of(const std::vector<double>& angles_rad) {
  std::vector<Sides> sides;
  sides.reserve(angles_rad.size());
  for (const double angle : angles_rad) sides.push_back({std::cos(angle), std::sin(angle)});
  return sides;
}

// The usable steps in turns, as functions of the direction u (in D):
//   theta / (2 pi) = phase + (lever + gamma * camera)' u,  theta of Eq. (6), Delta h of Eq. (1).
ArraySpectrum::ArraySpectrum(const AntennaArray& array) {
  const Eigen::Index n = array.usable.count();
  phase_.resize(n);
  lever_.resize(n, 3);
  camera_.resize(n, 3);
  turns_.resize(n);
  square_.resize(n);
  const Eigen::Matrix3d R_D_V = array.R_V_D.conjugate().toRotationMatrix();
  const double turns_per_m = 2.0 / array.wavelength_m;  // 4 pi / lambda, in turns
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < array.steps(); ++i) {
    if (!array.usable(i)) continue;
    phase_(row) = array.phase_step_rad(i) / kTwoPi;
    lever_.row(row) = turns_per_m * (R_D_V * (array.lever_V_m.col(i + 1) - array.lever_V_m.col(i))).transpose();
    camera_.row(row) = turns_per_m * (R_D_V * (array.camera_V.col(i + 1) - array.camera_V.col(i))).transpose();
    ++row;
  }
}

double ArraySpectrum::power_along(const Eigen::Vector3d& u) {
  turns_ = phase_ + slope_.col(0) * u.x() + slope_.col(1) * u.y() + slope_.col(2) * u.z();
  cosine_of_turns(turns_, square_);
  return turns_.sum() / static_cast<double>(phase_.size());
}

double ArraySpectrum::power(const IncidentAngles& angles, double gamma) {
  hold(gamma);
  return power_along(direction_of(angles));
}

void ArraySpectrum::raise(GridPeak& peak, const DirectionGrid& grid, std::size_t direction) {
  const double here = power_along(grid.unit_vector(direction));
  if (here > peak.power) peak = {here, direction};
}

std::vector<PlaneWaveStep> ArraySpectrum::kernel_steps() const {
  std::vector<PlaneWaveStep> steps(static_cast<std::size_t>(phase_.size()));
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    steps[i].phase_step_q16 = phase_q16(phase_(row));
    for (int axis = 0; axis < 3; ++axis) {
      steps[i].lever_turns[static_cast<std::size_t>(axis)] = static_cast<float>(lever_(row, axis));
      steps[i].camera_turns[static_cast<std::size_t>(axis)] = static_cast<float>(camera_(row, axis));
    }
  }
  return steps;
}

bool ArraySpectrum::fits_kernel(const GammaSteps& scales) const {
  return phase_.size() <= kMaxTerms_q15 && longest(lever_ + scales.first * camera_) < kMaxFirst_turns &&
         longest(scales.step * camera_) < kMaxStep_turns;
}

std::vector<GridPeak> ArraySpectrum::peaks(const DirectionGrid& grid, const GammaSteps& scales) {
  RFMVO_ASSERT(!empty() && grid.size() > 0);
  if (!fits_kernel(scales)) return peaks_in_double(grid, scales);
  const PlaneWaveSpectrum kernel(
      kernel_steps(), ScaleSteps{static_cast<float>(scales.first), static_cast<float>(scales.step), scales.count});
  std::vector<GridPeak> peaks(static_cast<std::size_t>(scales.count));
  std::vector<std::int32_t> sums;
  for (int begin = 0; begin < scales.count; begin += kScalesAtATime) {
    const int end = std::min(begin + kScalesAtATime, scales.count);
    sums.resize(grid.size() * static_cast<std::size_t>(end - begin));
    kernel.evaluate(grid.directions(), begin, end, sums);
    for (int n = begin; n < end; ++n) {
      const std::int32_t* row = &sums[grid.size() * static_cast<std::size_t>(n - begin)];
      const double within = 2.8 * kernel.max_abs_error(n) * kOne_q15 * kernel.steps();  // 2 e
      const double least = *std::max_element(row, row + grid.size()) - within;
      hold(scales.at(n));
      for (std::size_t d = 0; d < grid.size(); ++d)
        if (row[d] >= least) raise(peaks[static_cast<std::size_t>(n)], grid, d);
    }
  }
  return peaks;
}

std::vector<GridPeak> ArraySpectrum::peaks_in_double(const DirectionGrid& grid, const GammaSteps& scales) {
  RFMVO_ASSERT(!empty() && grid.size() > 0);
  std::vector<GridPeak> peaks(static_cast<std::size_t>(scales.count));
  for (int n = 0; n < scales.count; ++n) {
    hold(scales.at(n));
    for (std::size_t d = 0; d < grid.size(); ++d) raise(peaks[static_cast<std::size_t>(n)], grid, d);
  }
  return peaks;
}

}  // namespace rfmvo
