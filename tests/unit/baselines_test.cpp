#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "baselines/known_reads.hpp"
#include "baselines/mobitagbot.hpp"
#include "baselines/tagoram.hpp"
#include "montecarlo/recording.hpp"

namespace rfmvo::baselines {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWavelength_m = 0.325;
// Half a step of the phasors' table, and what the weight changes within it at most: 2 / (sqrt(pi) 0.2) per rad.
constexpr double kTableError_rad = kPi / 4096;
constexpr double kWeightSlope = 5.65;

// Two antennas along a weave of 2 m, 1.5 m from the tag; hopping over ten channels, which share one wavelength.
std::vector<KnownRead> reads_of(const Eigen::Vector3d& tag_m, double offset_rad = 0.4) {
  std::vector<KnownRead> reads;
  for (int i = 0; i < 60; ++i)
    for (int group = 0; group < 2; ++group) {
      const double s = 2.0 * i / 59 - 1.0;
      KnownRead read;
      read.p_W_A_m = Eigen::Vector3d(s, 0.15 * std::sin(4.0 * s), 0.3 * group);
      const double turns = 2.0 * (tag_m - read.p_W_A_m).norm() / kWavelength_m;
      read.phase_rad = 2.0 * kPi * (turns - std::floor(turns)) + offset_rad + 1.7 * group;
      read.wavelength_m = kWavelength_m;
      read.frequency_hz = 920'625'000U + 500'000U * static_cast<std::uint32_t>(i * 3 % 10);
      read.group = group;
      reads.push_back(read);
    }
  return reads;
}

// Odd numbers of cells: the centre is a cell's.
Region small_region(const Eigen::Vector3d& centre_m) { return {centre_m, {21, 21, 11}, 0.02}; }

const Eigen::Vector3d kTag_m(0.2, 1.5, 0.4);

TEST(Tagoram, PeaksAtTheTruthWithoutNoise) {
  const HologramPeak peak = locate_by_tagoram(reads_of(kTag_m), small_region(kTag_m));
  EXPECT_LT((peak.p_W_X_m - kTag_m).norm(), 1e-9);
  // All phasors are 1; the first read of each antenna has none.
  EXPECT_NEAR(peak.likelihood, 118.0, 118.0 * kWeightSlope * kTableError_rad);
  EXPECT_FALSE(peak.at_edge);
}

TEST(Tagoram, ConstantOffsetsOfTagAndAntennaDoNotMoveIt) {
  Tagoram base(reads_of(kTag_m, 0.0));
  for (const double offset_rad : {0.7, 2.9, 5.5}) {
    Tagoram shifted(reads_of(kTag_m, offset_rad));
    for (const Eigen::Vector3d& off : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.05, -0.02, 0.03)})
      EXPECT_NEAR(shifted.likelihood(kTag_m + off), base.likelihood(kTag_m + off),
                  118.0 * 2.0 * kWeightSlope * kTableError_rad);
  }
}

// The definition in plain loops and double: differences of phases and of distances, each wrapped, weighted by a
// Gaussian's two tails.
double tagoram_by_definition(const std::vector<KnownRead>& reads, const Eigen::Vector3d& p) {
  double re = 0.0, im = 0.0;
  for (int group = 0; group < 2; ++group) {
    const KnownRead* first = nullptr;
    for (const KnownRead& read : reads) {
      if (read.group != group) continue;
      if (first == nullptr) {
        first = &read;
        continue;
      }
      const double measured = read.phase_rad - first->phase_rad;
      const double expected = 4.0 * kPi / kWavelength_m * ((p - read.p_W_A_m).norm() - (p - first->p_W_A_m).norm());
      double delta = std::fmod(measured - expected, 2.0 * kPi);
      if (delta > kPi) delta -= 2.0 * kPi;
      if (delta < -kPi) delta += 2.0 * kPi;
      const double sigma = 0.1 * std::sqrt(2.0);
      const double cumulative = 0.5 * (1.0 + std::erf(std::abs(delta) / (sigma * std::sqrt(2.0))));
      const double weight = 2.0 * (1.0 - cumulative);
      re += weight * std::cos(delta);
      im += weight * std::sin(delta);
    }
  }
  return std::sqrt(re * re + im * im);
}

TEST(Tagoram, LikelihoodIsItsDefinition) {
  auto reads = reads_of(kTag_m);
  for (std::size_t i = 0; i < reads.size(); ++i)
    reads[i].phase_rad += 0.3 * std::sin(static_cast<double>(7 * i));  // a made-up noise
  Tagoram tagoram(reads);
  for (int n = 0; n < 40; ++n) {
    const Eigen::Vector3d p = kTag_m + 0.1 * Eigen::Vector3d(std::sin(3 * n), std::cos(5 * n), std::sin(7 * n));
    EXPECT_NEAR(tagoram.likelihood(p), tagoram_by_definition(reads, p), 118.0 * kWeightSlope * kTableError_rad) << n;
  }
}

TEST(Tagoram, SaysWhenTheLikeliestCellIsAtTheEdge) {
  const Eigen::Vector3d beside = kTag_m + Eigen::Vector3d(0.25, 0.0, 0.0);  // the truth is outside of it
  EXPECT_TRUE(locate_by_tagoram(reads_of(kTag_m), small_region(beside)).at_edge);
}

TEST(MobiTagbot, PeaksAtTheTruthWithoutNoiseWhateverTheOffsets) {
  for (const double offset_rad : {0.0, 2.2, 5.1}) {
    const HologramPeak peak = locate_by_mobitagbot(reads_of(kTag_m, offset_rad), small_region(kTag_m));
    EXPECT_LT((peak.p_W_X_m - kTag_m).norm(), 1e-9);
    EXPECT_NEAR(peak.likelihood, 120.0, 1e-3);
  }
}

TEST(MobiTagbot, LikelihoodIsTheSumOverAntennasOfTheSizesOfTheirPhasorSums) {
  const auto reads = reads_of(kTag_m);
  MobiTagbot tagbot(reads);
  const Eigen::Vector3d p = kTag_m + Eigen::Vector3d(0.04, 0.07, -0.03);
  double expected = 0.0;
  for (int group = 0; group < 2; ++group) {
    double re = 0.0, im = 0.0;
    for (const KnownRead& read : reads) {
      if (read.group != group) continue;
      const double angle = read.phase_rad - 4.0 * kPi / kWavelength_m * (p - read.p_W_A_m).norm();
      re += std::cos(angle);
      im += std::sin(angle);
    }
    expected += std::hypot(re, im);
  }
  EXPECT_NEAR(tagbot.likelihood(p), expected, 120.0 * kTableError_rad);
}

TEST(MobiTagbot, LeavesOutThePlaceWhereChannelsDisagree) {
  auto reads = reads_of(kTag_m);
  for (KnownRead& read : reads)  // multipath: the phase turns with the channel
    if (read.group == 1 && std::abs(read.p_W_A_m.x()) < 0.2)
      read.phase_rad += 2e-6 * (read.frequency_hz - 920'625'000U);
  const std::vector<bool> clear = clear_of_multipath(reads, kTag_m);
  std::size_t excluded = 0;
  for (std::size_t i = 0; i < reads.size(); ++i) {
    if (clear[i]) continue;
    ++excluded;
    EXPECT_EQ(reads[i].group, 1);
    EXPECT_LT(std::abs(reads[i].p_W_A_m.x()), 0.2 + kLocationLength_m);
  }
  EXPECT_GT(excluded, 4U);
  const HologramPeak peak = locate_by_mobitagbot(reads, small_region(kTag_m));
  EXPECT_LT((peak.p_W_X_m - kTag_m).norm(), 1e-9);
}

TEST(MobiTagbot, KeepsAtLeastHalfOfTheReads) {
  auto reads = reads_of(kTag_m);
  for (std::size_t i = 0; i < reads.size(); ++i) reads[i].phase_rad = static_cast<double>(i * i);  // noise everywhere
  const std::vector<bool> clear = clear_of_multipath(reads, kTag_m);
  EXPECT_GE(2 * std::count(clear.begin(), clear.end(), true), static_cast<std::ptrdiff_t>(reads.size()));
  EXPECT_LT(std::count(clear.begin(), clear.end(), true), static_cast<std::ptrdiff_t>(reads.size()));
}

TEST(MobiTagbot, FindsNothingSuspiciousInCleanPhases) {
  const std::vector<bool> clear = clear_of_multipath(reads_of(kTag_m), kTag_m);
  EXPECT_TRUE(std::all_of(clear.begin(), clear.end(), [](bool c) { return c; }));
}

TEST(KnownReads, FitTheTrueGeometryAcrossChannels) {
  simulate::Options options;
  options.scene = "wall";
  options.tags = 2;
  options.structured_rad = 0.0;
  options.flip_share = 0.0;
  const auto recording = montecarlo::record(options, nullptr);
  ASSERT_TRUE(recording.ok()) << recording.error().text();
  const auto by_tag = known_reads(recording.value().events, recording.value().truth);
  ASSERT_EQ(by_tag.size(), 2U);
  for (const simulate::TrueTag& tag : recording.value().truth.tags) {
    for (const auto& group : by_group(by_tag.at(tag.epc))) {
      ASSERT_GT(group.size(), 100U);  // both ports are calibrated: one group each
      double re = 0.0, im = 0.0;
      for (const KnownRead& read : group) {
        const double angle = read.phase_rad - 4.0 * kPi / read.wavelength_m * (tag.p_W_X_m - read.p_W_A_m).norm();
        re += std::cos(angle);
        im += std::sin(angle);
      }
      // White noise of 0.2 rad and 0.1 rad of hopping left: exp(-0.05 / 2) = 0.975.
      EXPECT_GT(std::hypot(re, im) / static_cast<double>(group.size()), 0.95);
    }
  }
}

}  // namespace
}  // namespace rfmvo::baselines
