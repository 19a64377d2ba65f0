#include "kernels/spherical_wave_spectrum.hpp"

#include <algorithm>
#include <cmath>

#include "base/assert.hpp"

namespace rfmvo {
namespace {

using Pair = SphericalWaveSpectrum::Pair;

constexpr float kInverseOne2_q15 = 1.0F / 1073741824.0F;  // 1 / 32768^2

float square(float a) { return a * a; }

// The angle that a wave turns from antenna `half` of the pair to a place.
std::uint16_t wave_angle(const Pair& p, std::size_t half, float x, float y, float z) {
  const float t = p.angle_per_m[half];
  const float yz = square((y - p.y_m[half]) * t) + square((z - p.z_m[half]) * t);
  const float angle = std::sqrt(yz + square((x - p.x_m[half]) * t));
  return static_cast<std::uint16_t>(std::lrint(angle));  // to even, in the default rounding mode
}

}  // namespace

SphericalWaveSpectrum::SphericalWaveSpectrum(std::span<const SphericalWaveRead> reads) {
  std::vector<SphericalWaveRead> sorted(reads.begin(), reads.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.group < b.group; });
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    while (end < sorted.size() && sorted[end].group == sorted[begin].group) ++end;
    RFMVO_ASSERT(end - begin <= static_cast<std::size_t>(kMaxTerms_q15));
    Group group{.first = pairs_.size()};
    for (std::size_t i = begin; i < end; i += 2) {
      const SphericalWaveRead &a = sorted[i], &b = sorted[std::min(i + 1, end - 1)];
      constexpr auto kAngles = static_cast<float>(kBinaryAnglesPerTurn);
      pairs_.push_back({{a.antenna_m[0], b.antenna_m[0]},
                        {a.antenna_m[1], b.antenna_m[1]},
                        {a.antenna_m[2], b.antenna_m[2]},
                        {kAngles * a.turns_per_m, kAngles * b.turns_per_m},
                        {a.phase_q16, b.phase_q16}});
    }
    group.end = pairs_.size();
    group.odd = (end - begin) % 2 != 0;
    group.weight = kInverseOne2_q15 / static_cast<float>(end - begin);
    groups_.push_back(group);
  }
  squares_.resize(pairs_.size());
}

void SphericalWaveSpectrum::evaluate_scalar(const CellBlock& block, BlockPower& power) const {
  for (int cell = 0; cell < kBlockCells; ++cell) {
    const auto [i, j, k] = cell_index(cell);
    const float x = block.first_m[0] + block.step_m[0] * static_cast<float>(i);
    const float y = block.first_m[1] + block.step_m[1] * static_cast<float>(j);
    const float z = block.first_m[2] + block.step_m[2] * static_cast<float>(k);
    float sum = 0.0F;
    for (const Group& group : groups_) {
      std::int32_t c = 0, s = 0;
      for (std::size_t p = group.first; p < group.end; ++p) {
        const std::size_t halves = group.odd && p + 1 == group.end ? 1 : 2;
        for (std::size_t half = 0; half < halves; ++half) {
          const auto angle =
              static_cast<std::uint16_t>(pairs_[p].phase_q16[half] - wave_angle(pairs_[p], half, x, y, z));
          c += cosine_q15(angle);
          s += sine_q15(angle);
        }
      }
      sum = sum + group.weight * (square(static_cast<float>(c)) + square(static_cast<float>(s)));
    }
    power[static_cast<std::size_t>(cell)] = sum;
  }
}

int strongest_cell_scalar(const BlockPower& power) {
  return static_cast<int>(std::max_element(power.begin(), power.end()) - power.begin());
}

}  // namespace rfmvo
