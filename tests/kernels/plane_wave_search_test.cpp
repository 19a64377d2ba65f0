#include "kernels/plane_wave_search.hpp"

#include <gtest/gtest.h>

#include "kernels/plane_wave_bound.hpp"
#include "kernels/scenes.hpp"

namespace rfmvo {
namespace {

using testing::Motion;
using testing::plane_wave_steps;
using testing::Random;

constexpr ScaleSteps kScales{.first = 0.5F, .step = 0.1F, .count = 16};

Motion motion_of(int n) {
  return std::array{Motion::kStraight, Motion::kTurning, Motion::kUneven}[static_cast<std::size_t>(n % 3)];
}

TEST(PlaneWaveBound, IsNowhereBelowTheSpectrum) {
  Random random(91);
  for (int n = 0; n < 300; ++n) {
    const auto steps = plane_wave_steps(random, 20, motion_of(n), 0.5);
    const auto centre = [&] { return random.uniform(-1.5, 1.5); };
    const std::array<double, 3> w0{centre(), centre(), centre()};
    const PlaneWaveBound bound(steps, curvature_of(steps), w0);
    for (int i = 0; i < 100; ++i) {
      const double reach = i % 2 == 0 ? 0.2 : 2.0;
      std::array<double, 3> w{};
      for (std::size_t axis = 0; axis < 3; ++axis) w[axis] = w0[axis] + random.uniform(-reach, reach);
      double power = 0.0;
      for (const PlaneWaveStep& s : steps) {
        double turns = s.phase_step_q16 / 65536.0;
        for (std::size_t axis = 0; axis < 3; ++axis) turns += s.camera_turns[axis] * w[axis];
        power += std::cos(reference::kTwoPi * turns) / static_cast<double>(steps.size());
      }
      EXPECT_GE(bound.at(w[0], w[1], w[2]), power);
      if (reach < 1.0) {
        EXPECT_LE(bound.at(w[0], w[1], w[2]), power + 0.2) << "a bound that bounds something";
      }
    }
  }
}

#ifdef RFMVO_EMULATED
constexpr int kCases = 200;  // the search is the same code everywhere, an emulator 30 times slower
#else
constexpr int kCases = 10000;
#endif

// The paper's grid (L = 60, 5 degrees, gamma 0.5 to 2.0 by 0.1) and others; one to three antennas.
TEST(PlaneWaveSearch, TenThousandCasesHaveTheSameCellAsTheFullGridWithAFifthOfTheTerms) {
  Random random(92);
  const AngleGrid paper(37), coarse(19), odd(32);
  std::int64_t full_terms = 0, terms = 0;
  for (int n = 0; n < kCases; ++n) {
    const AngleGrid& grid = n % 10 == 0 ? paper : n % 10 == 1 ? odd : coarse;
    const int length = n % 5 == 0 ? 59 : random.integer(5, 59);
    std::vector<PlaneWaveSteps> antennas;
    for (int m = 0; m < n % 3 + 1; ++m)
      antennas.push_back(plane_wave_steps(random, length, motion_of(n / 3), random.uniform(0.0, 0.6)));
    const SpectrumMaximum full = search_full_grid(antennas, kScales, grid);
    const SpectrumMaximum bounded = search_bounded(antennas, kScales, grid);
    ASSERT_EQ(bounded, full) << n;
    if (grid.count() != paper.count()) continue;
    full_terms += full.terms;
    terms += bounded.terms;
  }
  RecordProperty("full_grid_terms_per_bounded_term_x100", static_cast<int>(100 * full_terms / terms));
  EXPECT_GE(full_terms, 5 * terms);
}

TEST(PlaneWaveSearch, TiesGoToTheSmallestScaleAndDirection) {
  // No motion: all cells are equal.
  const std::vector<PlaneWaveSteps> antennas(2, PlaneWaveSteps(9));
  const AngleGrid grid(19);
  const SpectrumMaximum full = search_full_grid(antennas, kScales, grid);
  EXPECT_EQ(full.scale, 0);
  EXPECT_EQ(full.directions, (std::vector<int>{0, 0}));
  EXPECT_EQ(search_bounded(antennas, kScales, grid), full);
}

TEST(PlaneWaveSearch, FindsTheTagAndTheScaleOfAPathInThreeDimensions) {
  Random random(93);
  const AngleGrid grid(37);
  std::vector<PlaneWaveSteps> antennas;
  for (int m = 0; m < 2; ++m) antennas.push_back(plane_wave_steps(random, 59, Motion::kUneven, 0.0));
  const SpectrumMaximum found = search_bounded(antennas, kScales, grid);
  EXPECT_NEAR(kScales.at(found.scale), 1.0, 0.11);
  EXPECT_GT(found.power, 0.99);
}

}  // namespace
}  // namespace rfmvo
