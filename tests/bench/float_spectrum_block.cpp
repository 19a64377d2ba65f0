#include "bench/float_spectrum_block.hpp"

#include <cmath>

namespace rfmvo::bench {
namespace {

constexpr std::size_t kGroups = 8;

struct Block {
  alignas(64) std::array<float, kBlockCells> x, y, z;
};

struct Accumulator {
  alignas(64) std::array<float, kBlockCells> c, s;
};

inline void sine_cosine_turns(float t, float& s, float& c) {
  const float a = std::fabs(t);
  const bool far = a > 0.25F;
  const float u = far ? std::copysign(0.5F - a, t) : t;
  const float u2 = u * u;
  s = u * (6.2831665F + u2 * (-41.337982F + u2 * (81.340325F + u2 * -71.079552F)));
  const float k = 0.99999950F + u2 * (-19.738976F + u2 * (64.930559F + u2 * (-85.283546F + u2 * 56.206116F)));
  c = far ? -k : k;
}

void add_read(const Block& block, const SphericalWaveRead& read, Accumulator& sum) {
  const float ax = read.antenna_m[0], ay = read.antenna_m[1], az = read.antenna_m[2];
  const float phase_turns = static_cast<float>(read.phase_q16) / 65536.0F;
  constexpr float kRound = 12582912.0F;  // 1.5 * 2^23: adding and subtracting it rounds to an integer
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    const float dx = block.x[i] - ax, dy = block.y[i] - ay, dz = block.z[i] - az;
    const float t = phase_turns - read.turns_per_m * std::sqrt(dx * dx + dy * dy + dz * dz);
    const float wrapped = t - ((t + kRound) - kRound);
    float s, c;
    sine_cosine_turns(wrapped, s, c);
    sum.c[i] += c;
    sum.s[i] += s;
  }
}

Block block_of(const CellBlock& cells) {
  Block block;
  for (std::size_t n = 0; n < kBlockCells; ++n) {
    block.x[n] = cells.first_m[0] + cells.step_m[0] * static_cast<float>(n / 16);
    block.y[n] = cells.first_m[1] + cells.step_m[1] * static_cast<float>(n / 4 % 4);
    block.z[n] = cells.first_m[2] + cells.step_m[2] * static_cast<float>(n % 4);
  }
  return block;
}

}  // namespace

BlockPower float_block_power(std::span<const SphericalWaveRead> reads, const CellBlock& cells) {
  const Block block = block_of(cells);
  BlockPower power{};
  for (std::size_t g = 0; g < kGroups; ++g) {
    float count = 0.0F;
    Accumulator sum{};
    for (const SphericalWaveRead& r : reads) {
      if (static_cast<std::size_t>(r.group) % kGroups != g) continue;
      add_read(block, r, sum);
      count += 1.0F;
    }
    if (count == 0.0F) continue;
    for (std::size_t i = 0; i < kBlockCells; ++i) power[i] += (sum.c[i] * sum.c[i] + sum.s[i] * sum.s[i]) / count;
  }
  return power;
}

}  // namespace rfmvo::bench
