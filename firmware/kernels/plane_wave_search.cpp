#include "kernels/plane_wave_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/assert.hpp"
#include "base/units.hpp"
#include "kernels/plane_wave_bound.hpp"

namespace rfmvo {
namespace {

// Cells that share one point of expansion: so many values of each angle, and of the scale.
constexpr int kBlockAngles = 6, kBlockScales = 4;
// Bounds are computed in double, of order one: rounding is far below this.
constexpr double kRounding = 1e-9;

std::array<double, 3> direction(double alpha_rad, double beta_rad) {  // Eq. (15)
  return {std::cos(alpha_rad) * std::cos(beta_rad), std::sin(alpha_rad) * std::cos(beta_rad), std::sin(beta_rad)};
}

struct Peak {
  int direction = 0;
  std::int32_t sum = std::numeric_limits<std::int32_t>::min();
};

// One antenna on the grid: the kernel, and an upper bound of its power in every cell.
class BoundedSpectrum {
 public:
  BoundedSpectrum(const PlaneWaveSteps& steps, const ScaleSteps& scales, const AngleGrid& grid);

  [[nodiscard]] double highest_bound(int scale) const { return highest_[static_cast<std::size_t>(scale)].bound; }
  // S of one scale, exact on the grid.
  [[nodiscard]] Peak peak(int scale);
  [[nodiscard]] double power(const Peak& peak) const { return kernel_.power(peak.sum); }
  [[nodiscard]] std::int64_t terms() const { return terms_; }

 private:
  void bound_block(const PlaneWaveSteps& steps, const PlaneWaveCurvature& curvature, int alpha, int beta, int scale);
  void raise(Peak& best, int scale);  // by the cells gathered

  struct Highest {
    double bound = -2.0;
    int direction = 0;
  };

  const AngleGrid& grid_;
  ScaleSteps scales_;
  PlaneWaveSpectrum kernel_;
  std::vector<float> bounds_;     // scale by scale
  std::vector<Highest> highest_;  // per scale
  std::int64_t terms_ = 0;
  std::vector<int> cells_;  // scratch of peak
  std::vector<float> x_, y_, z_;
  std::vector<std::int32_t> sums_;
};

BoundedSpectrum::BoundedSpectrum(const PlaneWaveSteps& steps, const ScaleSteps& scales, const AngleGrid& grid)
    : grid_(grid),
      scales_(scales),
      kernel_(steps, scales),
      bounds_(grid.size() * static_cast<std::size_t>(scales.count)),
      highest_(static_cast<std::size_t>(scales.count)) {
  const PlaneWaveCurvature curvature = curvature_of(steps);
  for (int n = 0; n < scales.count; n += kBlockScales)
    for (int a = 0; a < grid.count(); a += kBlockAngles)
      for (int b = 0; b < grid.count(); b += kBlockAngles) bound_block(steps, curvature, a, b, n);
}

void BoundedSpectrum::bound_block(const PlaneWaveSteps& steps, const PlaneWaveCurvature& curvature, int alpha, int beta,
                                  int scale) {
  const int count = grid_.count();
  const int a_end = std::min(alpha + kBlockAngles, count), b_end = std::min(beta + kBlockAngles, count);
  const int n_end = std::min(scale + kBlockScales, scales_.count);
  const double step_rad = kPi / (count - 1);
  const auto u0 = direction(0.5 * (alpha + a_end - 1) * step_rad, 0.5 * (beta + b_end - 1) * step_rad);
  const double gamma0 = 0.5 * (scales_.at(scale) + scales_.at(n_end - 1));
  const PlaneWaveBound bound(steps, curvature, {gamma0 * u0[0], gamma0 * u0[1], gamma0 * u0[2]});
  terms_ += 2 * static_cast<std::int64_t>(steps.size());
  const Directions u = grid_.directions();
  for (int n = scale; n < n_end; ++n) {
    const double gamma = scales_.at(n), error = kernel_.max_abs_error(n) + kRounding;
    Highest& highest = highest_[static_cast<std::size_t>(n)];
    for (int a = alpha; a < a_end; ++a)
      for (int b = beta; b < b_end; ++b) {
        const int cell = a * count + b;
        const auto d = static_cast<std::size_t>(cell);
        const double here = bound.at(gamma * double{u.x[d]}, gamma * double{u.y[d]}, gamma * double{u.z[d]}) + error;
        // float: half an ulp of numbers up to a few units.
        bounds_[static_cast<std::size_t>(n) * grid_.size() + d] = static_cast<float>(here * (1.0 + 1e-6) + 1e-6);
        if (here > highest.bound) highest = {here, cell};
      }
  }
}

void BoundedSpectrum::raise(Peak& best, int scale) {
  const Directions u = grid_.directions();
  x_.clear(), y_.clear(), z_.clear();
  for (const int d : cells_) {
    x_.push_back(u.x[static_cast<std::size_t>(d)]);
    y_.push_back(u.y[static_cast<std::size_t>(d)]);
    z_.push_back(u.z[static_cast<std::size_t>(d)]);
  }
  sums_.resize(cells_.size());
  kernel_.evaluate({x_, y_, z_}, scale, scale + 1, sums_);
  terms_ += static_cast<std::int64_t>(cells_.size()) * kernel_.steps();
  for (std::size_t i = 0; i < cells_.size(); ++i)
    if (sums_[i] > best.sum || (sums_[i] == best.sum && cells_[i] < best.direction)) best = {cells_[i], sums_[i]};
}

Peak BoundedSpectrum::peak(int scale) {
  const Highest& highest = highest_[static_cast<std::size_t>(scale)];
  Peak best;
  cells_ = {highest.direction};
  raise(best, scale);
  const double found = power(best);
  cells_.clear();
  const float* bounds = &bounds_[static_cast<std::size_t>(scale) * grid_.size()];
  for (int d = 0; d < static_cast<int>(grid_.size()); ++d)
    if (double{bounds[d]} >= found && d != highest.direction) cells_.push_back(d);
  raise(best, scale);
  return best;
}

// Raises `best` by a scale whose peaks are known.
void compare(SpectrumMaximum& best, int scale, double power, std::vector<int> directions) {
  if (power < best.power || (power == best.power && scale > best.scale)) return;
  best.scale = scale;
  best.power = power;
  best.directions = std::move(directions);
}

SpectrumMaximum nothing_yet() {
  return {.scale = std::numeric_limits<int>::max(), .directions = {}, .power = -2.0, .terms = 0};
}

}  // namespace

AngleGrid::AngleGrid(int count) : count_(count) {
  RFMVO_ASSERT(count >= 2);
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < count; ++b) {
      const auto u = direction(a * kPi / (count - 1), b * kPi / (count - 1));
      x_.push_back(static_cast<float>(u[0]));
      y_.push_back(static_cast<float>(u[1]));
      z_.push_back(static_cast<float>(u[2]));
    }
}

SpectrumMaximum search_full_grid(std::span<const PlaneWaveSteps> antennas, const ScaleSteps& scales,
                                 const AngleGrid& grid) {
  SpectrumMaximum best = nothing_yet();
  const auto count = static_cast<std::size_t>(scales.count);
  std::vector<double> power(count, 0.0);
  std::vector<std::vector<int>> directions(count);
  std::vector<std::int32_t> sums(count * grid.size());
  for (const PlaneWaveSteps& steps : antennas) {
    const PlaneWaveSpectrum kernel(steps, scales);
    kernel.evaluate(grid.directions(), 0, scales.count, sums);
    best.terms += static_cast<std::int64_t>(sums.size()) * kernel.steps();
    for (std::size_t n = 0; n < count; ++n) {
      const auto first = sums.begin() + static_cast<std::ptrdiff_t>(n * grid.size());
      const auto peak = std::max_element(first, first + static_cast<std::ptrdiff_t>(grid.size()));
      power[n] += kernel.power(*peak) / static_cast<double>(antennas.size());
      directions[n].push_back(static_cast<int>(peak - first));
    }
  }
  for (std::size_t n = 0; n < count; ++n) compare(best, static_cast<int>(n), power[n], std::move(directions[n]));
  return best;
}

SpectrumMaximum search_bounded(std::span<const PlaneWaveSteps> antennas, const ScaleSteps& scales,
                               const AngleGrid& grid) {
  std::vector<BoundedSpectrum> spectra;
  for (const PlaneWaveSteps& steps : antennas) spectra.emplace_back(steps, scales, grid);
  const auto share = [&](double power) { return power / static_cast<double>(antennas.size()); };
  std::vector<double> bound(static_cast<std::size_t>(scales.count), kRounding);
  for (int n = 0; n < scales.count; ++n)
    for (const BoundedSpectrum& s : spectra) bound[static_cast<std::size_t>(n)] += share(s.highest_bound(n));
  std::vector<int> order(bound.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return bound[static_cast<std::size_t>(a)] > bound[static_cast<std::size_t>(b)];
  });
  SpectrumMaximum best = nothing_yet();
  for (const int n : order) {
    double left = bound[static_cast<std::size_t>(n)];  // bound of what is not known yet, plus what is
    double power = 0.0;
    std::vector<int> directions;
    for (BoundedSpectrum& s : spectra) {
      if (left < best.power) break;
      const Peak peak = s.peak(n);
      left += share(s.power(peak)) - share(s.highest_bound(n));
      power += share(s.power(peak));
      directions.push_back(peak.direction);
    }
    if (directions.size() == spectra.size()) compare(best, n, power, std::move(directions));
  }
  for (const BoundedSpectrum& s : spectra) best.terms += s.terms();
  return best;
}

}  // namespace rfmvo
