#include "estimator/near_field_spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/units.hpp"

namespace rfmvo {
namespace {

constexpr int kSide = 4;                         // a block is 4 x 4 x 4 cells,
constexpr int kCells = kSide * kSide * kSide;    // evaluated together
constexpr std::size_t kMaxGroups = 8;
constexpr float kFarRange_m = 3.0F;              // from here on cells may be twice as wide

struct Block {
  alignas(64) std::array<float, kCells> x, y, z;
};

// sin and cos of t turns, |t| <= 0.5: odd and even polynomials (minimax fits on a quarter turn of the
// squared argument); absolute error below 2e-4, far below one read's noise.
inline void sine_cosine_turns(float t, float& s, float& c) {
  // Fold to |u| <= 0.25 by the half-turn symmetry: sin(pi - a) = sin a, cos(pi - a) = -cos a.
  const float a = std::fabs(t);
  const bool far = a > 0.25F;
  const float u = far ? std::copysign(0.5F - a, t) : t;
  const float u2 = u * u;
  s = u * (6.2831665F + u2 * (-41.337982F + u2 * (81.340325F + u2 * -71.079552F)));
  const float k = 0.99999950F + u2 * (-19.738976F + u2 * (64.930559F + u2 * (-85.283546F + u2 * 56.206116F)));
  c = far ? -k : k;
}

void fill(Block& block, const Eigen::Vector3f& corner, const Eigen::Vector3f& cell) {
  std::size_t n = 0;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k, ++n) {
        block.x[n] = corner.x() + cell.x() * (static_cast<float>(i) + 0.5F);
        block.y[n] = corner.y() + cell.y() * (static_cast<float>(j) + 0.5F);
        block.z[n] = corner.z() + cell.z() * (static_cast<float>(k) + 0.5F);
      }
}

struct Accumulator {
  alignas(64) std::array<float, kCells> c, s;
};

void add_read(const Block& block, const SpectrumRead& read, Accumulator& sum) {
  const float ax = read.p_W_A.x(), ay = read.p_W_A.y(), az = read.p_W_A.z();
  constexpr float kRound = 12582912.0F;  // 1.5 * 2^23: adding and subtracting it rounds to an integer
  for (std::size_t i = 0; i < kCells; ++i) {
    const float dx = block.x[i] - ax, dy = block.y[i] - ay, dz = block.z[i] - az;
    const float t = read.phase_turns - read.turns_per_m * std::sqrt(dx * dx + dy * dy + dz * dz);
    const float wrapped = t - ((t + kRound) - kRound);
    float s, c;
    sine_cosine_turns(wrapped, s, c);
    sum.c[i] += c;
    sum.s[i] += s;
  }
}

std::array<float, kMaxGroups> inverse_counts(std::span<const SpectrumRead> reads) {
  std::array<float, kMaxGroups> count{};
  for (const SpectrumRead& r : reads) count[static_cast<std::size_t>(r.group) % kMaxGroups] += 1.0F;
  for (float& n : count) n = n > 0.0F ? 1.0F / n : 0.0F;
  return count;
}

// The strongest cell of a block.
SpectrumPeak strongest(const Block& block, std::span<const SpectrumRead> reads,
                       const std::array<float, kMaxGroups>& inverse_count) {
  std::array<float, kCells> power{};
  for (std::size_t g = 0; g < kMaxGroups; ++g) {
    if (inverse_count[g] == 0.0F) continue;
    Accumulator sum;
    sum.c.fill(0.0F);
    sum.s.fill(0.0F);
    for (const SpectrumRead& r : reads)
      if (static_cast<std::size_t>(r.group) % kMaxGroups == g) add_read(block, r, sum);
    for (std::size_t i = 0; i < kCells; ++i)
      power[i] += inverse_count[g] * (sum.c[i] * sum.c[i] + sum.s[i] * sum.s[i]);
  }
  const auto best = static_cast<std::size_t>(std::max_element(power.begin(), power.end()) - power.begin());
  return {Eigen::Vector3d(block.x[best], block.y[best], block.z[best]), power[best], 0.0};
}

// Is the block's centre where the antennas could have read it from?
bool in_beam(const Eigen::Vector3f& centre, const Eigen::Vector3f& cell, std::span<const SpectrumRead> reads,
             const SpectrumOptions& o) {
  const std::size_t stride = std::max<std::size_t>(1, reads.size() / 16);
  const float slack = 0.5F * kSide * cell.norm();  // half the block's diagonal
  const float cosine = std::cos(static_cast<float>(o.beam_half_angle_rad));
  int seen = 0, asked = 0;
  for (std::size_t i = 0; i < reads.size(); i += stride, ++asked) {
    const Eigen::Vector3f ray = centre - reads[i].p_W_A;
    const float range = ray.norm();
    if (range < static_cast<float>(o.range_min_m) - slack || range > static_cast<float>(o.range_max_m) + slack) continue;
    if (ray.dot(reads[i].boresight_W) + slack >= cosine * range) ++seen;
  }
  return seen >= o.beam_min_share * asked;
}

std::vector<SpectrumPeak> separated(std::vector<SpectrumPeak> peaks, const SpectrumOptions& options) {
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const SpectrumPeak& a, const SpectrumPeak& b) { return a.power > b.power; });
  std::vector<SpectrumPeak> kept;
  constexpr double kCellsApart = 1.5;
  for (const SpectrumPeak& p : peaks) {
    if (static_cast<int>(kept.size()) >= options.max_peaks) break;
    const bool near_a_stronger_one = std::any_of(kept.begin(), kept.end(), [&](const SpectrumPeak& k) {
      return (k.p_W_X - p.p_W_X).cwiseQuotient(options.cell_m).norm() < kCellsApart;
    });
    if (!near_a_stronger_one) kept.push_back(p);
  }
  return kept;
}

std::vector<SpectrumRead> thinned(std::span<const SpectrumRead> reads, std::size_t count) {
  std::vector<SpectrumRead> some;
  count = std::min(count, reads.size());
  for (std::size_t i = 0; i < count; ++i) some.push_back(reads[i * reads.size() / count]);
  return some;
}

struct Bounds {
  Eigen::Vector3f low, high;
};
Bounds bounds_of(std::span<const SpectrumRead> reads) {
  Bounds b{reads[0].p_W_A, reads[0].p_W_A};
  for (const SpectrumRead& r : reads) {
    b.low = b.low.cwiseMin(r.p_W_A);
    b.high = b.high.cwiseMax(r.p_W_A);
  }
  return b;
}

// The strongest cell of every block in the beam.
std::vector<SpectrumPeak> sift(std::span<const SpectrumRead> reads, const SpectrumOptions& options) {
  // A tag is within range of nearly every read, so of the outermost.
  const Bounds b = bounds_of(reads);
  const Eigen::Vector3f reach =
      Eigen::Vector3f::Constant(static_cast<float>(options.range_max_m)).cwiseMax(b.high - b.low);
  const Eigen::Vector3f first = b.high - reach, last = b.low + reach;
  const Eigen::Vector3f cell = options.cell_m.cast<float>();
  const Eigen::Vector3f step = kSide * cell;
  const std::array<float, kMaxGroups> inverse_count = inverse_counts(reads);
  const Eigen::Vector3f middle = 0.5F * (b.low + b.high);
  std::vector<SpectrumPeak> peaks;
  Block block;
  const auto evaluate = [&](const Eigen::Vector3f& corner, const Eigen::Vector3f& block_cell) {
    fill(block, corner, block_cell);
    peaks.push_back(strongest(block, reads, inverse_count));
  };
  // The aperture resolves an angle: cells twice as wide do where the range is twice the usual one.
  const Eigen::Vector3f coarse = 2.0F * step;
  for (float x = first.x(); x < last.x(); x += coarse.x())
    for (float y = first.y(); y < last.y(); y += coarse.y())
      for (float z = first.z(); z < last.z(); z += coarse.z()) {
        const Eigen::Vector3f corner(x, y, z);
        const Eigen::Vector3f centre = corner + step;
        if (!in_beam(centre, 2.0F * cell, reads, options)) continue;
        if ((centre - middle).norm() > kFarRange_m) {
          evaluate(corner, 2.0F * cell);
          continue;
        }
        for (int octant = 0; octant < 8; ++octant) {
          const Eigen::Vector3f part(static_cast<float>(octant & 1), static_cast<float>((octant >> 1) & 1),
                                     static_cast<float>(octant >> 2));
          const Eigen::Vector3f own = corner + part.cwiseProduct(step);
          if (in_beam(own + 0.5F * step, cell, reads, options)) evaluate(own, cell);
        }
      }
  return peaks;
}

}  // namespace

Eigen::Vector3d suitable_cell(std::span<const SpectrumRead> reads, double finest_m, double widest_m) {
  constexpr double kUsualRange_m = 1.5, kMaxSpread = 1.4, kCurvature = 0.2;
  const Bounds b = bounds_of(reads);
  Eigen::Vector3d cell;
  for (int i = 0; i < 3; ++i) {
    // Spread of the direction cosine along this axis over the aperture.
    const double spread = std::min(kMaxSpread, static_cast<double>(b.high[i] - b.low[i]) / kUsualRange_m) + kCurvature;
    const double wavenumber = kTwoPi * static_cast<double>(reads[0].turns_per_m);
    cell[i] = std::clamp(4.0 / (wavenumber * spread), finest_m, widest_m);  // half a cell times half the spread: 1 rad
  }
  return cell;
}

std::vector<SpectrumPeak> search_near_field(std::span<const SpectrumRead> reads, const SpectrumOptions& options) {
  if (reads.empty()) return {};
  const std::vector<SpectrumRead> some = thinned(reads, options.sifting_reads);
  std::vector<SpectrumPeak> peaks = sift(some, options);
  for (SpectrumPeak& p : peaks) p.cells = static_cast<double>(peaks.size()) * kCells;
  if (some.size() < reads.size()) {
    constexpr std::size_t kJudgedPerPeak = 12;
    const std::size_t judged = std::min(peaks.size(), kJudgedPerPeak * static_cast<std::size_t>(options.max_peaks));
    std::partial_sort(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(judged), peaks.end(),
                      [](const SpectrumPeak& a, const SpectrumPeak& b) { return a.power > b.power; });
    peaks.resize(judged);
    for (SpectrumPeak& p : peaks) p.power = near_field_power(reads, p.p_W_X);
  }
  return separated(std::move(peaks), options);
}

double near_field_power(std::span<const SpectrumRead> reads, const Eigen::Vector3d& p_W_X) {
  const std::array<float, kMaxGroups> inverse_count = inverse_counts(reads);
  double power = 0.0;
  for (std::size_t g = 0; g < kMaxGroups; ++g) {
    double c = 0.0, s = 0.0;
    for (const SpectrumRead& r : reads) {
      if (static_cast<std::size_t>(r.group) % kMaxGroups != g) continue;
      const double turns = r.phase_turns - r.turns_per_m * (p_W_X - r.p_W_A.cast<double>()).norm();
      c += std::cos(kTwoPi * turns);
      s += std::sin(kTwoPi * turns);
    }
    power += inverse_count[g] * (c * c + s * s);
  }
  return power;
}

}  // namespace rfmvo
