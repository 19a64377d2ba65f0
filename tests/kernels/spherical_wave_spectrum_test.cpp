#include "kernels/spherical_wave_spectrum.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "kernels/scenes.hpp"
#include "kernels/simd_targets.hpp"
#include "kernels/spectrum_reference.hpp"

namespace rfmvo {
namespace {

using testing::for_each_target;
using testing::Guarded;
using testing::Random;
using testing::random_block;
using testing::random_reads;

std::vector<reference::SphericalRead> in_double(std::span<const SphericalWaveRead> reads) {
  std::vector<reference::SphericalRead> exact;
  for (const SphericalWaveRead& r : reads)
    exact.push_back({{r.antenna_m[0], r.antenna_m[1], r.antenna_m[2]},
                     static_cast<double>(r.turns_per_m),
                     reference::kTwoPi * r.phase_q16 / 65536.0,
                     r.group});
  return exact;
}

reference::Point centre_of(const CellBlock& block, int cell) {
  const auto [i, j, k] = cell_index(cell);
  return {block.first_m[0] + i * block.step_m[0], block.first_m[1] + j * block.step_m[1],
          block.first_m[2] + k * block.step_m[2]};
}

void expect_same_bits(std::span<const SphericalWaveRead> reads, const CellBlock& block) {
  SphericalWaveSpectrum spectrum(reads);
  BlockPower expected;
  spectrum.evaluate_scalar(block, expected);
  Guarded<BlockPower> got;
  spectrum.evaluate(block, got.value);
  ASSERT_EQ(std::memcmp(&got.value, &expected, sizeof expected), 0);
  ASSERT_TRUE(got.intact());
}

TEST(SphericalWaveSpectrum, EveryTargetEqualsTheScalarDefinitionToTheLastBit) {
  for_each_target([] {
    Random random(71);
    for (int count = 0; count <= 70; ++count)
      for (int groups = 1; groups <= 9; groups += 4) {
        expect_same_bits(random_reads(random, count, groups), random_block(random, count % 2 == 0 ? 2.0 : 20.0));
        if (::testing::Test::HasFatalFailure()) return;
      }
  });
}

TEST(SphericalWaveSpectrum, EveryTargetEqualsTheDefinitionAtTheAntennaAndFarAway) {
  for_each_target([] {
    Random random(72);
    const auto reads = random_reads(random, 21, 3);
    CellBlock at_antenna{reads[4].antenna_m, {0.0F, 0.05F, 0.0F}};
    expect_same_bits(reads, at_antenna);
    expect_same_bits(reads, random_block(random, 2500.0));  // within the header's 2^15 turns
  });
}

TEST(SphericalWaveSpectrum, ScalarIsWithinTheHeadersBoundOfTheReferenceAndTheBoundIsTight) {
  Random random(73);
  double worst = 0.0;
  for (int n = 0; n < 400; ++n) {
    // Few reads: their errors average out less.
    const int count = n % 8 == 0 ? 24 : random.integer(1, 4);
    const auto reads = random_reads(random, count, n % 3 + 1);
    const auto exact = in_double(reads);
    const CellBlock block = random_block(random, 5.0);  // 5 m along each axis: less than 60 turns
    BlockPower power;
    SphericalWaveSpectrum(reads).evaluate_scalar(block, power);
    for (int cell = 0; cell < kBlockCells; ++cell) {
      const double error = power[static_cast<std::size_t>(cell)] - reference::power(exact, centre_of(block, cell));
      worst = std::max(worst, std::abs(error) / count);
    }
  }
  RecordProperty("worst_share_of_bound_percent", static_cast<int>(100.0 * worst / kMeanPowerMaxAbsError));
  EXPECT_LE(worst, kMeanPowerMaxAbsError);
  EXPECT_GE(worst, 0.1 * kMeanPowerMaxAbsError);
}

TEST(SphericalWaveSpectrum, PowerOfOneTagWithoutNoiseIsTheNumberOfReadsAndOffsetsDoNotMoveIt) {
  Random random(74);
  for (int n = 0; n < 50; ++n) {
    auto reads = random_reads(random, 24, 4);
    const CellBlock block = random_block(random, 3.0);
    const int cell = random.integer(0, kBlockCells - 1);
    const reference::Point tag = centre_of(block, cell);
    const std::array<double, 5> offset_turns{0.0, 0.3, 0.71, 0.05, 0.9};
    for (SphericalWaveRead& r : reads) {
      const reference::Point antenna{r.antenna_m[0], r.antenna_m[1], r.antenna_m[2]};
      const double turns = static_cast<double>(r.turns_per_m) * reference::distance(antenna, tag) +
                           offset_turns[static_cast<std::size_t>(r.group)];
      r.phase_q16 = testing::code_of_turns(turns);
    }
    BlockPower power;
    SphericalWaveSpectrum(reads).evaluate(block, power);
    // The phase is rounded once more: half a code.
    const double bound = 24.0 * (kMeanPowerMaxAbsError + 2.0 * 0.5 * reference::kTwoPi / 65536.0);
    EXPECT_NEAR(power[static_cast<std::size_t>(cell)], 24.0, bound);
    EXPECT_EQ(strongest_cell(power), cell);
  }
}

TEST(SphericalWaveSpectrum, StrongestCellIsThatOfTheReferenceUnlessTheyAreEqualWithinTheBound) {
  Random random(75);
  for (int n = 0; n < 300; ++n) {
    const auto reads = random_reads(random, 24, 2);
    const CellBlock block = random_block(random, 3.0);
    BlockPower power;
    SphericalWaveSpectrum(reads).evaluate(block, power);
    const auto exact = in_double(reads);
    double best = 0.0;
    for (int cell = 0; cell < kBlockCells; ++cell)
      best = std::max(best, reference::power(exact, centre_of(block, cell)));
    const double of_found = reference::power(exact, centre_of(block, strongest_cell(power)));
    EXPECT_GE(of_found, best - 2.0 * 24.0 * kMeanPowerMaxAbsError);
  }
}

TEST(SphericalWaveSpectrum, EveryTargetFindsTheFirstOfTheStrongestCells) {
  for_each_target([] {
    Random random(76);
    for (int n = 0; n < 2000; ++n) {
      BlockPower power;  // few values: many ties
      for (float& p : power) p = static_cast<float>(random.integer(0, n % 70));
      ASSERT_EQ(strongest_cell(power), strongest_cell_scalar(power));
    }
  });
}

TEST(SphericalWaveSpectrum, NoReadsNoPower) {
  BlockPower power;
  SphericalWaveSpectrum({}).evaluate({}, power);
  for (const float p : power) EXPECT_EQ(p, 0.0F);
  EXPECT_EQ(strongest_cell(power), 0);
}

}  // namespace
}  // namespace rfmvo
