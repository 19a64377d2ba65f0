// The spatial power spectrum of Eq. (6) for spherical waves, in fixed point: for a place x and groups g of
// reads i that share an unknown offset,
//   power(x) = sum over g of |S_g|^2 / n_g,   S_g = sum over i in g of exp j(phi_i - 2 pi t_i |a_i - x|).
//
// Format:     phases and t |a - x| are binary angles (binary_angle.hpp); phasors are Q15, their sums int32,
//             powers float in units of one phasor squared: at most the number of reads.
// Distance:   float, in units of 1/65536 turn: sqrt(((z-az) t)^2 + ((y-ay) t)^2 + ((x-ax) t)^2), the first two
//             squares summed first, rounded to the nearest integer (half to even). IEEE operations without
//             contraction (-ffp-contract=off) have the same bits on every target.
// Range:      t |a - x| below 2^15 turns; at most kMaxTerms_q15 reads per group.
// Saturation: none after the sine and cosine: int32 sums hold kMaxTerms_q15 of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/binary_angle.hpp"

namespace rfmvo {

struct SphericalWaveRead {
  std::array<float, 3> antenna_m{};
  float turns_per_m = 0.0F;  // 2 f / c
  std::uint16_t phase_q16 = 0;
  int group = 0;  // any number; reads of one group share their unknown offset
};

// Cells of a block: 4 along each axis, z the fastest.
inline constexpr int kBlockSide = 4;
inline constexpr int kBlockCells = kBlockSide * kBlockSide * kBlockSide;

// (i, j, k) of a cell.
[[nodiscard]] constexpr std::array<int, 3> cell_index(int cell) {
  return {cell / (kBlockSide * kBlockSide), cell / kBlockSide % kBlockSide, cell % kBlockSide};
}

// Centres: first + step * (i, j, k).
struct CellBlock {
  std::array<float, 3> first_m{}, step_m{};
};

struct alignas(64) BlockPower : std::array<float, kBlockCells> {};

// A phasor's error: that of sine and cosine, and of the distance. Half a code is its rounding to an integer; one
// rounding (2^-24) each of difference, scale, square, two sums and root is 4.5 roundings of the distance, 1.1 codes
// at 60 turns; 0.15 codes are a cell's centre, rounded twice.
inline constexpr double kPhasorMaxTurns = 60.0;
inline constexpr double kPhasorMaxAbsError = 1.415 * kCosineMaxAbsError + 1.75 * 6.2832 / kBinaryAnglesPerTurn;

// Of power / reads: | |S + e|^2 - |S|^2 | <= 2 |S| |e| + |e|^2, |S| and |e| per read.
inline constexpr double kMeanPowerMaxAbsError = kPhasorMaxAbsError * (2.0 + kPhasorMaxAbsError);

// Reads in the order of evaluation: by group, two per 32-bit lane.
class SphericalWaveSpectrum {
 public:
  struct Pair {
    std::array<float, 2> x_m, y_m, z_m;  // antennas
    std::array<float, 2> angle_per_m;    // 65536 t
    std::array<std::uint16_t, 2> phase_q16;
  };
  struct Group {
    std::size_t first = 0, end = 0;  // pairs
    bool odd = false;                // the last pair's second read does not count
    float weight = 0.0F;             // 2^-30 / n_g
  };
  using PairSquares = std::array<float, std::size_t{2} * kBlockSide>;  // (t (x_i - ax))^2 of both reads

  explicit SphericalWaveSpectrum(std::span<const SphericalWaveRead> reads);

  // On the best vector unit of this machine. Not const: fills scratch.
  void evaluate(const CellBlock& block, BlockPower& power);
  // The definition: the same bits.
  void evaluate_scalar(const CellBlock& block, BlockPower& power) const;

  [[nodiscard]] std::span<const Pair> pairs() const { return pairs_; }
  [[nodiscard]] std::span<const Group> groups() const { return groups_; }

 private:
  std::vector<Pair> pairs_;
  std::vector<Group> groups_;
  std::vector<PairSquares> squares_;
};

// The first of the strongest cells; no power is NaN.
[[nodiscard]] int strongest_cell(const BlockPower& power);
[[nodiscard]] int strongest_cell_scalar(const BlockPower& power);

}  // namespace rfmvo
