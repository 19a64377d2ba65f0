#include "kernels/spherical_wave_spectrum.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "kernels/simd_targets.hpp"
#include "kernels/spectrum_reference.hpp"

namespace rfmvo {
namespace {

using testing::for_each_target;

class Scene {
 public:
  explicit Scene(unsigned seed) : random_(seed) {}

  float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  // Antennas along a path of 1.6 m, phases of a reader's 12 bits or any.
  std::vector<SphericalWaveRead> reads(int count, int groups) {
    std::vector<SphericalWaveRead> reads;
    for (int i = 0; i < count; ++i)
      reads.push_back({{uniform(-0.8F, 0.8F), uniform(-0.1F, 0.1F), uniform(0.0F, 0.6F)},
                       uniform(6.10F, 6.20F),
                       static_cast<std::uint16_t>(integer(0, 65535)),
                       integer(1, groups)});
    return reads;
  }

  CellBlock block(float reach_m) {
    return {{uniform(-reach_m, reach_m), uniform(-reach_m, reach_m), uniform(-reach_m, reach_m)},
            {uniform(0.01F, 0.2F), uniform(0.01F, 0.2F), uniform(0.01F, 0.2F)}};
  }

 private:
  std::mt19937 random_;
};

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
  const double i = cell / 16, j = cell / 4 % 4, k = cell % 4;
  return {block.first_m[0] + i * block.step_m[0], block.first_m[1] + j * block.step_m[1],
          block.first_m[2] + k * block.step_m[2]};
}

// Poison on both sides of what is written.
struct Guarded {
  std::array<float, 16> before;
  BlockPower power;
  std::array<float, 16> after;

  Guarded() { std::memset(static_cast<void*>(this), 0xA5, sizeof *this); }
  [[nodiscard]] bool intact() const {
    const Guarded fresh;
    return std::memcmp(&before, &fresh.before, sizeof before) == 0 &&
           std::memcmp(&after, &fresh.after, sizeof after) == 0;
  }
};

void expect_same_bits(std::span<const SphericalWaveRead> reads, const CellBlock& block) {
  SphericalWaveSpectrum spectrum(reads);
  BlockPower expected;
  spectrum.evaluate_scalar(block, expected);
  Guarded got;
  spectrum.evaluate(block, got.power);
  ASSERT_EQ(std::memcmp(&got.power, &expected, sizeof expected), 0);
  ASSERT_TRUE(got.intact());
}

TEST(SphericalWaveSpectrum, EveryTargetEqualsTheScalarDefinitionToTheLastBit) {
  for_each_target([] {
    Scene scene(71);
    for (int count = 0; count <= 70; ++count)
      for (int groups = 1; groups <= 9; groups += 4)
        expect_same_bits(scene.reads(count, groups), scene.block(count % 2 == 0 ? 2.0F : 20.0F));
  });
}

TEST(SphericalWaveSpectrum, EveryTargetEqualsTheDefinitionAtTheAntennaAndFarAway) {
  for_each_target([] {
    Scene scene(72);
    const auto reads = scene.reads(21, 3);
    CellBlock at_antenna{reads[4].antenna_m, {0.0F, 0.05F, 0.0F}};
    expect_same_bits(reads, at_antenna);
    expect_same_bits(reads, scene.block(2500.0F));  // within the header's 2^15 turns
  });
}

TEST(SphericalWaveSpectrum, ScalarIsWithinTheHeadersBoundOfTheReferenceAndTheBoundIsTight) {
  Scene scene(73);
  double worst = 0.0;
  for (int n = 0; n < 400; ++n) {
    // Few reads: their errors average out less.
    const int count = n % 8 == 0 ? 24 : scene.integer(1, 4);
    const auto reads = scene.reads(count, n % 3 + 1);
    const auto exact = in_double(reads);
    const CellBlock block = scene.block(5.0F);  // 5 m along each axis: less than 60 turns
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
  Scene scene(74);
  for (int n = 0; n < 50; ++n) {
    auto reads = scene.reads(24, 4);
    const CellBlock block = scene.block(3.0F);
    const int cell = scene.integer(0, kBlockCells - 1);
    const reference::Point tag = centre_of(block, cell);
    const std::array<double, 5> offset_turns{0.0, 0.3, 0.71, 0.05, 0.9};
    for (SphericalWaveRead& r : reads) {
      const reference::Point antenna{r.antenna_m[0], r.antenna_m[1], r.antenna_m[2]};
      const double turns = static_cast<double>(r.turns_per_m) * reference::distance(antenna, tag) +
                           offset_turns[static_cast<std::size_t>(r.group)];
      r.phase_q16 = static_cast<std::uint16_t>(static_cast<std::int64_t>(std::llround(turns * 65536.0)));
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
  Scene scene(75);
  for (int n = 0; n < 300; ++n) {
    const auto reads = scene.reads(24, 2);
    const CellBlock block = scene.block(3.0F);
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

TEST(SphericalWaveSpectrum, NoReadsNoPower) {
  BlockPower power;
  SphericalWaveSpectrum({}).evaluate({}, power);
  for (const float p : power) EXPECT_EQ(p, 0.0F);
  EXPECT_EQ(strongest_cell(power), 0);
}

}  // namespace
}  // namespace rfmvo
