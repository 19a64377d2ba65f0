#include <gtest/gtest.h>

#include "base/units.hpp"
#include "estimator/near_field_spectrum.hpp"
#include "kernels/spherical_wave_spectrum.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::random_vector;

constexpr double kTurns_m = 2.0 * 921e6 / joint_scene::kLight_m_s;
const Eigen::Vector3d kTag(0.8, 1.6, 0.25);

// Two antennas of different height on a 1.6 m path along x, looking to the left (y).
std::vector<SpectrumRead> reads_of(const Eigen::Vector3d& tag, int per_antenna, double weave_m = 0.1) {
  std::vector<SpectrumRead> reads;
  for (int g = 0; g < 2; ++g)
    for (int i = 0; i < per_antenna; ++i) {
      SpectrumRead r;
      const double x = 1.6 * i / (per_antenna - 1);
      const Eigen::Vector3d p(x, weave_m * std::sin(4.0 * x), g == 0 ? 0.0 : 0.5);
      r.p_W_A = p.cast<float>();
      r.boresight_W = Eigen::Vector3f::UnitY();
      r.turns_per_m = static_cast<float>(kTurns_m);
      const double turns = kTurns_m * (p - tag).norm() + 0.3 * g;
      r.phase_turns = static_cast<float>(turns - std::round(turns));
      r.group = g;
      reads.push_back(r);
    }
  return reads;
}

SpectrumOptions all_reads(std::span<const SpectrumRead> reads) {
  return {.cell_m = suitable_cell(reads, 0.03, 0.2), .sifting_reads = 1000, .range_max_m = 4.0};
}

TEST(NearFieldSpectrum, PowerIsTheNumberOfReadsAtTheTruthAndNowhereMore) {
  const auto reads = reads_of(kTag, 30);
  // Phases in float are off by some 1e-6 turns and enter squared.
  EXPECT_NEAR(near_field_power(reads, kTag), 60.0, 1e-5);
  std::mt19937 random(61);
  for (int i = 0; i < 1000; ++i) EXPECT_LE(near_field_power(reads, kTag + random_vector(random, 2.0)), 60.0 + 1e-5);
}

TEST(NearFieldSpectrum, PowerIsNoiseFarFromTheTruth) {
  // Unit phasors at random: power of each group averages 1. The sidelobes are structured; a third is generous.
  const auto reads = reads_of(kTag, 30);
  EXPECT_LT(near_field_power(reads, kTag + Eigen::Vector3d(0.5, -0.4, 0.6)), 20.0);
}

TEST(NearFieldSpectrum, TheOffsetOfAGroupDoesNotMatter) {
  auto reads = reads_of(kTag, 20);
  std::mt19937 random(62);
  for (int n = 0; n < 20; ++n) {
    const Eigen::Vector3d p = kTag + random_vector(random, 0.2);
    auto shifted = reads;
    for (SpectrumRead& r : shifted) r.phase_turns += r.group == 0 ? 0.125F : 0.25F;  // nearly exact in float
    EXPECT_NEAR(near_field_power(shifted, p), near_field_power(reads, p), 1e-4);     // 40 reads, 2 pi 1e-7 turns each
  }
}

TEST(NearFieldSpectrum, ReadsOfOneGroupMustAgreeOnTheirOffset) {
  auto reads = reads_of(kTag, 20);
  for (SpectrumRead& r : reads) r.group = 0;
  // Two antennas 0.3 turns apart in one sum: (cos(0.3 pi))^2 of the power.
  EXPECT_NEAR(near_field_power(reads, kTag), 40.0 * std::pow(std::cos(0.3 * joint_scene::kPi), 2), 1e-3);
}

TEST(NearFieldSpectrum, SearchInFixedPointIsThePowerInDouble) {
  std::mt19937 random(63);
  for (int n = 0; n < 4; ++n) {
    auto reads = reads_of(kTag, 25);
    std::uniform_real_distribution<float> uniform(-0.5F, 0.5F);
    if (n > 0)
      for (SpectrumRead& r : reads) r.phase_turns = uniform(random);  // no tag: every part of the circle
    SpectrumOptions options = all_reads(reads);
    options.max_peaks = 200;
    const auto peaks = search_near_field(reads, options);
    ASSERT_GT(peaks.size(), 20U);
    // The kernel's bound, and half a code of rounding every phase.
    const double bound = kMeanPowerMaxAbsError + 2.0 * 0.5 * kTwoPi / kBinaryAnglesPerTurn;
    for (const SpectrumPeak& peak : peaks)
      EXPECT_NEAR(peak.power / 50.0, near_field_power(reads, peak.p_W_X) / 50.0, bound);
  }
}

TEST(NearFieldSpectrum, PeakIsAtTheTruthWithinACell) {
  // Ports whose offsets are known, on a weaving path: an aperture in all three axes. Of a flatter one the peak is a
  // ridge several cells long.
  for (const Eigen::Vector3d& tag : {kTag, Eigen::Vector3d(0.2, 1.2, 0.6), Eigen::Vector3d(0.6, 1.4, 0.1)}) {
    auto reads = reads_of(tag, 20, 0.4);
    for (SpectrumRead& r : reads) {
      r.phase_turns -= 0.3F * static_cast<float>(r.group);
      r.group = 0;
    }
    for (const std::size_t sifting : {24UL, 1000UL}) {
      SpectrumOptions options = all_reads(reads);
      options.sifting_reads = sifting;
      options.cell_m.setConstant(0.04);
      options.range_max_m = 2.5;
      const auto peaks = search_near_field(reads, options);
      ASSERT_FALSE(peaks.empty());
      EXPECT_LE((peaks[0].p_W_X - tag).cwiseQuotient(options.cell_m).cwiseAbs().maxCoeff(), 1.0)
          << sifting << ": " << peaks[0].p_W_X.transpose();
      // 2 cm along each axis is at most 38.6 rad/m * 3.5 cm = 1.3 rad, and the mean of it goes into the offset.
      EXPECT_GT(peaks[0].power, 0.75 * 40.0);
    }
  }
}

TEST(NearFieldSpectrum, PeaksComeStrongestFirstAndApart) {
  const auto reads = reads_of(kTag, 30);
  const SpectrumOptions options = all_reads(reads);
  const auto peaks = search_near_field(reads, options);
  ASSERT_LE(peaks.size(), 12U);
  for (std::size_t i = 0; i < peaks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_LE(peaks[i].power, peaks[j].power);
      EXPECT_GE((peaks[i].p_W_X - peaks[j].p_W_X).cwiseQuotient(options.cell_m).norm(), 1.5);
    }
}

TEST(NearFieldSpectrum, FindsNothingBehindTheAntennas) {
  const Eigen::Vector3d behind(0.8, -1.6, 0.25);
  const auto reads = reads_of(behind, 30);
  SpectrumOptions options = all_reads(reads);
  options.cell_m.setConstant(0.04);
  options.range_max_m = 2.5;
  // A block of cells that reaches into the beam counts as in it: half of its diagonal.
  const double slack = 2.0 * options.cell_m.norm();
  for (const SpectrumPeak& peak : search_near_field(reads, options)) EXPECT_GT(peak.p_W_X.y(), -2.0 * slack);
  // The same reads, the antennas turned round: there it is.
  auto turned = reads;
  for (SpectrumRead& r : turned) r.boresight_W = -r.boresight_W;
  const auto found = search_near_field(turned, options);
  ASSERT_FALSE(found.empty());
  EXPECT_LE((found[0].p_W_X - behind).cwiseQuotient(options.cell_m).cwiseAbs().maxCoeff(), 1.0);
}

TEST(NearFieldSpectrum, FindsNothingWhereNoAntennaPairLooks) {
  auto reads = reads_of(kTag, 30);
  for (SpectrumRead& r : reads)
    if (r.group == 1) r.boresight_W = -r.boresight_W;
  SpectrumOptions options = all_reads(reads);
  options.cell_m.setConstant(0.06);
  options.range_min_m = 1.5;  // beyond the slack of a block
  options.beam_half_angle_rad = 0.5;
  EXPECT_TRUE(search_near_field(reads, options).empty());
  EXPECT_TRUE(search_near_field({}, options).empty());
}

TEST(NearFieldSpectrum, CellIsFineAlongTheApertureCoarseAcrossAndKeepsThePeak) {
  const auto reads = reads_of(kTag, 30);
  const Eigen::Vector3d cell = suitable_cell(reads, 0.01, 1.0);
  EXPECT_LT(cell.x(), cell.y());
  EXPECT_LT(cell.x(), cell.z());
  // Half a cell off along one axis: at most a radian to either side, so at least cos(1) of the amplitude.
  for (const Eigen::Vector3d& tag : {kTag, Eigen::Vector3d(0.2, 1.2, 0.6), Eigen::Vector3d(1.5, 2.0, -0.3)})
    for (int axis = 0; axis < 3; ++axis)
      for (const double half : {-0.5, 0.5}) {
        const Eigen::Vector3d off = half * cell[axis] * Eigen::Vector3d::Unit(axis);
        EXPECT_GT(near_field_power(reads_of(tag, 30), tag + off), 0.29 * 60.0) << axis;
      }
  const Eigen::Vector3d clamped = suitable_cell(reads, 0.06, 0.07);
  EXPECT_GE(clamped.minCoeff(), 0.06);
  EXPECT_LE(clamped.maxCoeff(), 0.07);
}

}  // namespace
}  // namespace rfmvo
