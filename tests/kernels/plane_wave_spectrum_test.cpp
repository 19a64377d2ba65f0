#include "kernels/plane_wave_spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernels/plane_wave_search.hpp"
#include "kernels/scenes.hpp"
#include "kernels/simd_targets.hpp"
#include "kernels/spectrum_reference.hpp"

namespace rfmvo {
namespace {

using testing::for_each_target;
using testing::Motion;
using testing::plane_wave_steps;
using testing::Random;

constexpr ScaleSteps kScales{.first = 0.5F, .step = 0.1F, .count = 16};

struct Sphere {
  std::vector<float> x, y, z;
  [[nodiscard]] Directions from(std::size_t first) const {
    return {std::span(x).subspan(first), std::span(y).subspan(first), std::span(z).subspan(first)};
  }
};

Sphere random_directions(Random& random, std::size_t count) {
  Sphere s;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = random.uniform(-1.0, 1.0), azimuth = random.uniform(0.0, reference::kTwoPi);
    s.x.push_back(static_cast<float>(std::sqrt(1.0 - z * z) * std::cos(azimuth)));
    s.y.push_back(static_cast<float>(std::sqrt(1.0 - z * z) * std::sin(azimuth)));
    s.z.push_back(static_cast<float>(z));
  }
  return s;
}

std::vector<PlaneWaveStep> any_steps(Random& random, int count) {
  std::vector<PlaneWaveStep> steps;
  const auto turns = [&] { return random.uniform_f(-3.0, 3.0); };
  for (int i = 0; i < count; ++i)
    steps.push_back({static_cast<std::uint16_t>(random.integer(0, 65535)),
                     {turns(), turns(), turns()},
                     {turns(), turns(), turns()}});
  return steps;
}

// Into the middle of a poisoned buffer, at any alignment.
void expect_same_bits(const PlaneWaveSpectrum& spectrum, const Directions& directions, int begin, int end,
                      std::size_t offset) {
  constexpr std::int32_t kPoison = 0x5A5A5A5A;
  const std::size_t count = directions.size() * static_cast<std::size_t>(end - begin);
  std::vector<std::int32_t> expected(count), got(offset + count + 32, kPoison);
  spectrum.evaluate_scalar(directions, begin, end, expected);
  spectrum.evaluate(directions, begin, end, std::span(got).subspan(offset, count));
  const auto first = got.begin() + static_cast<std::ptrdiff_t>(offset),
             last = first + static_cast<std::ptrdiff_t>(count);
  ASSERT_TRUE(std::equal(first, last, expected.begin())) << directions.size() << " directions";
  const auto poison = [](std::int32_t s) { return s == kPoison; };
  ASSERT_TRUE(std::all_of(got.begin(), first, poison) && std::all_of(last, got.end(), poison));
}

TEST(PlaneWaveSpectrum, EveryTargetEqualsTheScalarDefinitionAtAllLengthsAndAlignments) {
  for_each_target([] {
    Random random(81);
    for (std::size_t count = 0; count <= 50; ++count)
      for (std::size_t offset = 0; offset < 4; ++offset) {
        const Sphere sphere = random_directions(random, count + offset);
        const PlaneWaveSpectrum spectrum(any_steps(random, random.integer(1, 9)), kScales);
        expect_same_bits(spectrum, sphere.from(offset), 0, 16, offset);
        if (::testing::Test::HasFatalFailure()) return;
      }
  });
}

TEST(PlaneWaveSpectrum, EveryTargetEqualsTheScalarDefinitionForAnyNumberOfStepsAndScales) {
  for_each_target([] {
    Random random(82);
    for (int count = 1; count <= 64; ++count) {
      const Sphere sphere = random_directions(random, 21);
      const PlaneWaveSpectrum spectrum(any_steps(random, count), kScales);
      const int begin = random.integer(0, 20);
      expect_same_bits(spectrum, sphere.from(0), begin, begin + random.integer(0, 20), 1);
      if (::testing::Test::HasFatalFailure()) return;
    }
  });
}

// Eq. (6) in double, of the same float inputs; the phase codes are exact.
double reference_power(std::span<const PlaneWaveStep> steps, double alpha_rad, double beta_rad, double gamma) {
  std::vector<reference::PlaneStep> exact;
  constexpr double kWavelength_m = 2.0;  // so that 2 / lambda is 1
  for (const PlaneWaveStep& s : steps)
    exact.push_back(
        {{s.camera_turns[0], s.camera_turns[1], s.camera_turns[2]}, reference::kTwoPi * s.phase_step_q16 / 65536.0});
  return reference::spatial_power(exact, kWavelength_m, alpha_rad, beta_rad, gamma);
}

TEST(PlaneWaveSpectrum, ScalarIsWithinTheHeadersBoundOfTheReferenceAndTheBoundIsTight) {
  Random random(83);
  double worst = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const auto steps = plane_wave_steps(random, random.integer(1, 3), Motion::kUneven, 1.0);
    const PlaneWaveSpectrum spectrum(steps, kScales);
    const double alpha = random.uniform(0.0, 3.14), beta = random.uniform(0.0, 3.14);
    const auto x = static_cast<float>(std::cos(alpha) * std::cos(beta));
    const auto y = static_cast<float>(std::sin(alpha) * std::cos(beta)), z = static_cast<float>(std::sin(beta));
    std::vector<std::int32_t> sums(16);
    spectrum.evaluate_scalar({{&x, 1}, {&y, 1}, {&z, 1}}, 0, 16, sums);
    for (int i = 0; i < 16; ++i) {
      const double exact = reference_power(steps, alpha, beta, kScales.at(i));
      const double error = std::abs(spectrum.power(sums[static_cast<std::size_t>(i)]) - exact);
      // The direction was rounded to float here: 2^-24 of at most 4 turns per step, three components.
      EXPECT_LE(error, spectrum.max_abs_error(i) + reference::kTwoPi * 4.0 * 3.0 / (1 << 24));
      worst = std::max(worst, error / spectrum.max_abs_error(i));
    }
  }
  RecordProperty("worst_share_of_bound_percent", static_cast<int>(100.0 * worst));
  EXPECT_GE(worst, 0.1);
}

// The same cell or a neighbour: on the sphere, because around the pole (beta = 90 degrees) and across the seam cells
// that lie next to each other have unlike numbers. A diagonal of 5 degrees.
constexpr double kCosineOfACell = 0.99235;

double cosine_between(const Directions& u, std::size_t a, std::size_t b) {
  return double{u.x[a]} * u.x[b] + double{u.y[a]} * u.y[b] + double{u.z[a]} * u.z[b];
}

TEST(PlaneWaveSpectrum, OneTagWithoutNoiseHasItsPeakOfOneAtTheTruth) {
  Random random(84);
  for (int n = 0; n < 50; ++n) {
    const AngleGrid grid(37);
    const Directions u = grid.directions();
    const auto truth = static_cast<std::size_t>(random.integer(0, 37 * 37 - 1));
    auto steps = plane_wave_steps(random, 59, Motion::kUneven, 0.0);
    for (PlaneWaveStep& s : steps) {
      const auto& c = s.camera_turns;
      s.phase_step_q16 =
          testing::code_of_turns(-double{c[0]} * u.x[truth] - double{c[1]} * u.y[truth] - double{c[2]} * u.z[truth]);
    }
    const PlaneWaveSpectrum spectrum(steps, {.first = 1.0F});
    std::vector<std::int32_t> sums(grid.size());
    spectrum.evaluate(u, 0, 1, sums);
    // 1 - cos of half a code of phase and one of truncation is nothing beside the bound.
    EXPECT_NEAR(spectrum.power(sums[truth]), 1.0, spectrum.max_abs_error(0));
    const auto peak = static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
    EXPECT_LE(spectrum.power(sums[peak]), 1.0 + spectrum.max_abs_error(0));
    EXPECT_GE(cosine_between(u, peak, truth), kCosineOfACell);
  }
}

TEST(PlaneWaveSpectrum, AConstantOffsetOfAllReadsDoesNotChangeABit) {
  Random random(85);
  std::vector<std::uint16_t> phases;
  for (int i = 0; i < 60; ++i) phases.push_back(static_cast<std::uint16_t>(random.integer(0, 65535)));
  const auto with_offset = [&](int offset) {
    Random same(86);
    auto steps = plane_wave_steps(same, 59, Motion::kUneven, 0.0);
    for (std::size_t i = 0; i < steps.size(); ++i)  // Delta phi of the phases as a reader with this offset reports them
      steps[i].phase_step_q16 = static_cast<std::uint16_t>(static_cast<std::uint16_t>(phases[i + 1] + offset) -
                                                           static_cast<std::uint16_t>(phases[i] + offset));
    const AngleGrid grid(10);
    std::vector<std::int32_t> sums(grid.size() * 16);
    PlaneWaveSpectrum(steps, kScales).evaluate(grid.directions(), 0, 16, sums);
    return sums;
  };
  for (const int offset : {1, 777, 20000, 65535}) EXPECT_EQ(with_offset(offset), with_offset(0));
}

TEST(PlaneWaveSpectrum, PeakIsTheDoublePeaksCellOrANeighbour) {
  Random random(87);
  constexpr int kCount = 37;
  const AngleGrid grid(kCount);
  for (int n = 0; n < 100; ++n) {
    // On a curved path: a straight one does not tell the directions around it apart.
    const auto steps = plane_wave_steps(random, 59, Motion::kUneven, 0.3);
    const PlaneWaveSpectrum spectrum(steps, {.first = 1.0F});
    std::vector<std::int32_t> sums(grid.size());
    spectrum.evaluate(grid.directions(), 0, 1, sums);
    const auto peak = static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
    std::size_t exact_peak = 0;
    double best = -2.0;
    for (int d = 0; d < kCount * kCount; ++d) {
      const double step_rad = reference::kTwoPi / 2 / (kCount - 1);
      const double power = reference_power(steps, d / kCount * step_rad, d % kCount * step_rad, 1.0);
      if (power > best) best = power, exact_peak = static_cast<std::size_t>(d);
    }
    EXPECT_GE(cosine_between(grid.directions(), peak, exact_peak), kCosineOfACell) << peak << " " << exact_peak;
  }
}

}  // namespace
}  // namespace rfmvo
