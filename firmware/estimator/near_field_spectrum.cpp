#include "estimator/near_field_spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/units.hpp"
#include "kernels/spherical_wave_spectrum.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

constexpr float kFarRange_m = 3.0F;  // from here on cells may be twice as wide

SphericalWaveSpectrum spectrum_of(std::span<const SpectrumRead> reads) {
  std::vector<SphericalWaveRead> waves;
  waves.reserve(reads.size());
  for (const SpectrumRead& r : reads) {
    const std::array<float, 3> antenna_m{r.p_W_A.x(), r.p_W_A.y(), r.p_W_A.z()};
    waves.push_back({antenna_m, r.turns_per_m, Phase::from_rad(kTwoPi * r.phase_turns).turn_q16, r.group});
  }
  return SphericalWaveSpectrum(waves);
}

// The strongest cell of a block.
SpectrumPeak strongest(SphericalWaveSpectrum& spectrum, const Eigen::Vector3f& corner, const Eigen::Vector3f& cell) {
  const Eigen::Vector3f first = corner + 0.5F * cell;
  BlockPower power;
  spectrum.evaluate({{first.x(), first.y(), first.z()}, {cell.x(), cell.y(), cell.z()}}, power);
  const int best = strongest_cell(power);
  const auto [i, j, k] = cell_index(best);
  const Eigen::Vector3f index(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k));
  return {(first + cell.cwiseProduct(index)).cast<double>(), power[static_cast<std::size_t>(best)], 0.0};
}

// Is the block's centre where the antennas could have read it from?
bool in_beam(const Eigen::Vector3f& centre, const Eigen::Vector3f& cell, std::span<const SpectrumRead> reads,
             const SpectrumOptions& o) {
  const std::size_t stride = std::max<std::size_t>(1, reads.size() / 16);
  const float slack = 0.5F * kBlockSide * cell.norm();  // half the block's diagonal
  const float cosine = std::cos(static_cast<float>(o.beam_half_angle_rad));
  const std::size_t asked = (reads.size() + stride - 1) / stride;
  const double needed = o.beam_min_share * static_cast<double>(asked);
  std::size_t missed = 0;
  for (std::size_t i = 0; i < reads.size(); i += stride) {
    const Eigen::Vector3f ray = centre - reads[i].p_W_A;
    const float range = ray.norm();
    if (range >= static_cast<float>(o.range_min_m) - slack && range <= static_cast<float>(o.range_max_m) + slack &&
        ray.dot(reads[i].boresight_W) + slack >= cosine * range)
      continue;
    ++missed;
    if (static_cast<double>(asked - missed) < needed) return false;
  }
  return true;
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
  const Eigen::Vector3f step = kBlockSide * cell;
  SphericalWaveSpectrum spectrum = spectrum_of(reads);
  const Eigen::Vector3f middle = 0.5F * (b.low + b.high);
  std::vector<SpectrumPeak> peaks;
  // The aperture resolves an angle: cells twice as wide do where the range is twice the usual one.
  const Eigen::Vector3f coarse = 2.0F * step;
  for (float x = first.x(); x < last.x(); x += coarse.x())
    for (float y = first.y(); y < last.y(); y += coarse.y())
      for (float z = first.z(); z < last.z(); z += coarse.z()) {
        const Eigen::Vector3f corner(x, y, z);
        const Eigen::Vector3f centre = corner + step;
        if (!in_beam(centre, 2.0F * cell, reads, options)) continue;
        if ((centre - middle).norm() > kFarRange_m) {
          peaks.push_back(strongest(spectrum, corner, 2.0F * cell));
          continue;
        }
        for (int octant = 0; octant < 8; ++octant) {
          const Eigen::Vector3f part(static_cast<float>(octant & 1), static_cast<float>((octant >> 1) & 1),
                                     static_cast<float>(octant >> 2));
          const Eigen::Vector3f own = corner + part.cwiseProduct(step);
          if (in_beam(own + 0.5F * step, cell, reads, options)) peaks.push_back(strongest(spectrum, own, cell));
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
  for (SpectrumPeak& p : peaks) p.cells = static_cast<double>(peaks.size()) * kBlockCells;
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
  struct Sum {
    int reads = 0;
    double c = 0.0, s = 0.0;
  };
  std::map<int, Sum> groups;
  for (const SpectrumRead& r : reads) {
    Sum& sum = groups[r.group];
    const double turns = r.phase_turns - r.turns_per_m * (p_W_X - r.p_W_A.cast<double>()).norm();
    ++sum.reads;
    sum.c += std::cos(kTwoPi * turns);
    sum.s += std::sin(kTwoPi * turns);
  }
  double power = 0.0;
  for (const auto& [group, sum] : groups) power += (sum.c * sum.c + sum.s * sum.s) / sum.reads;
  return power;
}

}  // namespace rfmvo
