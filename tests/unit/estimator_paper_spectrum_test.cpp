#include <gtest/gtest.h>

#include "estimator/array_spectrum.hpp"
#include "estimator/spatial_power_spectrum.hpp"
#include "unit/estimator_paper_scene.hpp"

namespace rfmvo {
namespace {

using paper_scene::kPi;
using paper_scene::kWavelength_m;

constexpr double kStep = 5.0 * kPi / 180.0;
// Direction on the search grid: alpha = 70 deg, beta = 35 deg.
const IncidentAngles kAngles{14 * kStep, 7 * kStep};

AntennaArray plane_array(double vertical, double gamma, double offset_rad = 0.3) {
  const auto path = paper_scene::weave(60, vertical);
  return paper_scene::array_of(path, paper_scene::plane_phases(path, direction_of(kAngles), offset_rad), gamma);
}

TEST(SpatialPowerSpectrum, IsOneAtTheTruthWithoutNoise) {
  // 1e-10: the cosine's stated error plus rounding of phases of some hundred turns.
  EXPECT_NEAR(spatial_power(plane_array(1.0, 1.7), kAngles, 1.7), 1.0, 1e-10);
}

TEST(SpatialPowerSpectrum, FindsScaleAndAnglesOnAPathInThreeDimensions) {
  const AntennaArray array = plane_array(1.0, 1.7);
  // The range is such that the truth is on the grid: step = 0.1 * 1.7.
  const SpectrumPeak peak = search_spectrum({&array, 1}, {1.7 * 0.5, 1.7 * 1.5}, kStep, 0.1);
  ASSERT_TRUE(peak.found);
  EXPECT_NEAR(peak.gamma, 1.7, 1e-9);
  EXPECT_NEAR(peak.power, 1.0, 1e-8);  // the three-term recurrence loses a few digits over ten scales
  EXPECT_NEAR(peak.angles[0].alpha_rad, kAngles.alpha_rad, 1e-12);
  EXPECT_NEAR(peak.angles[0].beta_rad, kAngles.beta_rad, 1e-12);
}

TEST(SpatialPowerSpectrum, PeakStaysWhenAllPhasesShiftTogether) {
  const SpectrumPeak base = [] {
    const AntennaArray array = plane_array(1.0, 1.7, 0.3);
    return search_spectrum({&array, 1}, {0.8, 2.6}, kStep, 0.1);
  }();
  for (const double offset : {0.9, 2.5, 4.0, 6.1}) {
    const AntennaArray array = plane_array(1.0, 1.7, offset);
    const SpectrumPeak peak = search_spectrum({&array, 1}, {0.8, 2.6}, kStep, 0.1);
    EXPECT_EQ(peak.gamma, base.gamma);
    EXPECT_NEAR(peak.power, base.power, 1e-10);
    EXPECT_EQ(peak.angles[0].alpha_rad, base.angles[0].alpha_rad);
    EXPECT_EQ(peak.angles[0].beta_rad, base.angles[0].beta_rad);
  }
}

TEST(SpatialPowerSpectrum, DoesNotDependOnTheUnitOfVisualOdometry) {
  const AntennaArray metres = plane_array(1.0, 1.0);
  const AntennaArray feet = plane_array(1.0, 0.3048);
  const ScaleLimits limits{1.0, 10.0, true};
  const SpectrumPeak a = search_spectrum({&metres, 1}, scale_range({&metres, 1}, limits), kStep, 0.1);
  const SpectrumPeak b = search_spectrum({&feet, 1}, scale_range({&feet, 1}, limits), kStep, 0.1);
  ASSERT_TRUE(a.found && b.found);
  EXPECT_NEAR(b.gamma / a.gamma, 0.3048, 1e-9);
  EXPECT_EQ(a.angles[0].alpha_rad, b.angles[0].alpha_rad);
  EXPECT_EQ(a.angles[0].beta_rad, b.angles[0].beta_rad);
}

TEST(SpatialPowerSpectrum, CannotTellScaleFromElevationOnAFlatPath) {
  // docs/paper.md: on a flat path P depends on gamma * cos(beta) only, so that the maximum over the angles is
  // the same for every gamma above gamma_true * cos(beta_true).
  const AntennaArray flat = plane_array(0.0, 1.0);
  const double across = std::cos(kAngles.beta_rad);
  for (const double gamma : {0.9, 1.0, 1.2, 1.4, 1.7}) {
    const IncidentAngles same{kAngles.alpha_rad, std::acos(across / gamma)};
    EXPECT_NEAR(spatial_power(flat, same, gamma), 1.0, 1e-10) << gamma;
  }
  // Out-of-plane motion tells them apart.
  const AntennaArray spatial = plane_array(1.0, 1.0);
  EXPECT_LT(spatial_power(spatial, {kAngles.alpha_rad, std::acos(across / 1.4)}, 1.4), 0.98);
}

TEST(SpatialPowerSpectrum, RefinementStaysOnTheGridAndImproves) {
  const AntennaArray array = plane_array(1.0, 1.7);
  const IncidentAngles off{kAngles.alpha_rad + 8 * kPi / 180, kAngles.beta_rad - 11 * kPi / 180};
  const IncidentAngles best = refine_angles(array, off, 1.7, kPi / 180, 20 * kPi / 180);
  EXPECT_NEAR(best.alpha_rad, kAngles.alpha_rad, 1e-9);
  EXPECT_NEAR(best.beta_rad, kAngles.beta_rad, 1e-9);
}

TEST(SpatialPowerSpectrum, IgnoresStepsThatAreNotComparable) {
  AntennaArray array = plane_array(1.0, 1.7);
  array.phase_step_rad(20) += 1.9;
  EXPECT_LT(spatial_power(array, kAngles, 1.7), 0.99);
  array.usable(20) = false;
  EXPECT_NEAR(spatial_power(array, kAngles, 1.7), 1.0, 1e-10);
}

DirectionGrid grid_of(int count) {
  std::vector<double> angles;
  for (int n = 0; n < count; ++n) angles.push_back(kPi * n / (count - 1));
  return {angles, angles};
}

// Noise, curvature, levers that turn, a step that cannot be compared; flat paths have directions that tie.
AntennaArray disturbed_array(int seed) {
  const auto path = paper_scene::weave(20 + seed % 41, seed % 3 == 0 ? 0.0 : 1.0);
  auto phases = paper_scene::tag_phases(path, {0.5, 1.2, 0.6}, 0.1 * seed);
  for (std::size_t i = 0; i < phases.size(); ++i)
    phases[i] += 0.2 * (seed % 7) * paper_scene::wobble(static_cast<int>(i) + 100 * seed);
  AntennaArray array = paper_scene::array_of(path, phases, 0.7 + 0.1 * (seed % 10));
  for (Eigen::Index i = 0; i < array.elements(); ++i)
    array.lever_V_m.col(i) = 0.02 * seed * Eigen::Vector3d(std::cos(0.03 * i), std::sin(0.03 * i), 0.1);
  array.usable(seed % array.steps()) = false;
  return array;
}

TEST(ArraySpectrum, SiftingByTheKernelKeepsThePeakToTheLastBit) {
  const DirectionGrid grid = grid_of(37);
  for (int seed = 0; seed < 24; ++seed) {
    ArraySpectrum spectrum(disturbed_array(seed));
    const GammaSteps scales{0.5, 0.1, 5 + seed % 12};
    const auto sifted = spectrum.peaks(grid, scales), all = spectrum.peaks_in_double(grid, scales);
    ASSERT_EQ(sifted.size(), all.size());
    for (std::size_t n = 0; n < all.size(); ++n) {
      EXPECT_EQ(sifted[n].direction, all[n].direction) << seed << ' ' << n;
      EXPECT_EQ(sifted[n].power, all[n].power) << seed << ' ' << n;
    }
  }
}

TEST(ArraySpectrum, PeakIsTheHighestPowerOfTheGrid) {
  ArraySpectrum spectrum(disturbed_array(5));
  const DirectionGrid grid = grid_of(13);
  const GammaSteps scales{0.6, 0.2, 4};
  const auto peaks = spectrum.peaks(grid, scales);
  for (int n = 0; n < scales.count; ++n)
    for (std::size_t d = 0; d < grid.size(); ++d)
      EXPECT_LE(spectrum.power(grid.angles(d), scales.at(n)), peaks[static_cast<std::size_t>(n)].power);
}

TEST(ArraySpectrum, StepsBeyondTheKernelsRangeAreSearchedAllTheSame) {
  AntennaArray array = disturbed_array(4);
  array.camera_V.rightCols(10).colwise() += Eigen::Vector3d(0.0, 40.0, 0.0);  // a gap of 40 units: 250 turns
  ArraySpectrum spectrum(array);
  const DirectionGrid grid = grid_of(10);
  const auto peak = spectrum.peaks(grid, {1.0, 0.1, 1}).front();
  EXPECT_EQ(peak.direction, spectrum.peaks_in_double(grid, {1.0, 0.1, 1}).front().direction);
  EXPECT_GT(peak.power, 0.0);
}

TEST(ScaleRange, HoldsTheTruthAtASlowEvenPace) {
  const AntennaArray array = plane_array(1.0, 1.7);  // about 5 cm every 0.1 s
  const ScaleRange range = scale_range({&array, 1}, {});
  EXPECT_LT(range.min, 1.7);
  EXPECT_GT(range.max, 1.7);
}

TEST(ScaleRange, LosesTheTruthWhenReadsAreMissedUnlessFixed) {
  auto path = paper_scene::weave(63, 1.0);
  path.erase(path.begin() + 30, path.begin() + 33);  // three missed reads: one step of 20 cm
  AntennaArray array = paper_scene::array_of(path, paper_scene::plane_phases(path, direction_of(kAngles), 0.0), 1.7);
  array.duration_s(29) = 0.4;
  EXPECT_LT(scale_range({&array, 1}, {1.0, 10.0, false}).max, 1.7);
  const ScaleRange fixed = scale_range({&array, 1}, {1.0, 10.0, true});
  EXPECT_LT(fixed.min, 1.7);
  EXPECT_GT(fixed.max, 1.7);
}

TEST(ScaleRange, LosesTheTruthWhenAShortStepIsNoisyUnlessFixed) {
  AntennaArray array = plane_array(1.0, 1.7);
  array.camera_V.rightCols(59).colwise() -= 0.95 * (array.camera_V.col(1) - array.camera_V.col(0));
  array.phase_step_rad(0) = 0.2;  // the camera hardly moved: this is noise
  EXPECT_GT(scale_range({&array, 1}, {1.0, 10.0, false}).min, 1.7);
  EXPECT_LT(scale_range({&array, 1}, {1.0, 10.0, true}).min, 1.7);
}

TEST(ScaleRange, IsEmptyForACameraAtRest) {
  AntennaArray array = plane_array(1.0, 1.7);
  array.camera_V.setZero();
  for (const bool fixed : {false, true}) {
    const ScaleRange range = scale_range({&array, 1}, {1.0, 10.0, fixed});
    EXPECT_TRUE(range.empty());
    EXPECT_FALSE(search_spectrum({&array, 1}, range, kStep, 0.1).found);
  }
}

}  // namespace
}  // namespace rfmvo
