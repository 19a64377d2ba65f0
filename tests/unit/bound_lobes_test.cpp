// Lobes: mirror places of small worlds, whose chances are known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "base/units.hpp"
#include "bound/lobes.hpp"
#include "unit/bound_world.hpp"

namespace rfmvo::bound {
namespace {

constexpr double kWave_rad_m = 4.0 * kPi * kFrequency_hz / kSpeedOfLight_m_s;
constexpr double kHeight_m = 0.4;  // of the tag above the antenna's plane

// One antenna on a weave that leaves its plane by so much.
World mirror_world(double wobble_m, int reads, double white_rad) {
  const auto pose = [wobble_m](double t_s) {
    const double x_m = kSpeed_m_s * t_s;
    return Rigid3{straight_pose(t_s).R, {x_m, 0.2 * std::sin(1.5 * x_m), wobble_m * std::sin(2.5 * x_m)}};
  };
  World world = world_with(pose, 4.0, {Eigen::Vector3d::Zero()});
  add_tag(world, {1.9, 1.5, kHeight_m}, reads, white_rad);
  return world;
}

Settings known_path() {
  Settings settings;
  settings.known_path = settings.known_lever_arms = true;
  return settings;
}

// Sum of squares of phase differences between the tag's place and another, offset free (its mean).
double squares(const World& world, const Eigen::Vector3d& other) {
  double sum = 0.0, square = 0.0;
  for (const Read& read : world.reads) {
    const Eigen::Vector3d antenna = world.T_S_C(read.t_s).t;
    const double difference = kWave_rad_m * ((antenna - world.tags[0].p_S_X_m).norm() - (antenna - other).norm());
    sum += difference;
    square += difference * difference;
  }
  return square - sum * sum / static_cast<double>(world.reads.size());
}

// The least of them about a place, by halving steps.
double least_squares_near(const World& world, Eigen::Vector3d place) {
  double least = squares(world, place);
  for (double step_m = 0.004; step_m > 1e-6;) {
    const double before = least;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        const Eigen::Vector3d there = place + sign * step_m * Eigen::Vector3d::Unit(axis);
        const double value = squares(world, there);
        if (value >= least) continue;
        least = value;
        place = there;
      }
    if (least == before) step_m *= 0.5;
  }
  return least;
}

TEST(Lobes, AMirrorIsACoinToToss) {
  const World world = mirror_world(0.0, 40, 0.1);
  const Lobes lobes = lobes_of(world, bound_of(world, known_path()), {.draws = 2000});
  ASSERT_GE(lobes.tags[0].lobes, 1U);
  EXPECT_NEAR(lobes.tags[0].wrong_probability, 0.5, 3.0 * std::sqrt(0.25 / 2000));
  EXPECT_NEAR(lobes.tags[0].square_m2, 0.5 * std::pow(2.0 * kHeight_m, 2), 0.03);
}

// Two places whose phases are d sigmas apart are confused with probability Q(d / 2).
TEST(Lobes, ANearMirrorIsLikelierAsOftenAsTheDistanceOfThePhasesSays) {
  for (const double white_rad : {0.15, 0.25, 0.4}) {
    const World world = mirror_world(0.006, 40, white_rad);
    const Eigen::Vector3d mirrored(1.9, 1.5, -kHeight_m);
    const double d = std::sqrt(least_squares_near(world, mirrored)) / white_rad;
    const double expected = 0.5 * std::erfc(0.5 * d / std::sqrt(2.0));
    const Lobes lobes = lobes_of(world, bound_of(world, known_path()), {.draws = 4000});
    ASSERT_GT(expected, 0.01);
    EXPECT_NEAR(lobes.tags[0].wrong_probability, expected, 0.004 + 3.5 * std::sqrt(expected * (1 - expected) / 4000))
        << white_rad << " rad, d = " << d;
  }
}

TEST(Lobes, WithoutNoiseOnlyTheBoundIsLeft) {
  const World world = mirror_world(0.1, 60, 0.01);
  const Bound bound = bound_of(world, known_path());
  const Lobes lobes = lobes_of(world, bound);
  EXPECT_EQ(lobes.wrong_share, 0.0);
  EXPECT_DOUBLE_EQ(lobes.rmse_m.value(), bound.rmse_m.value());
}

TEST(Lobes, ASecondHeightOfAntennasEndsTheMirror) {
  const auto wrong = [](std::vector<Eigen::Vector3d> lever_arms) {
    World world = mirror_world(0.0, 0, 0.1);
    world.tags.clear();
    world.lever_arms_C_m = std::move(lever_arms);
    world.structured.sigma_rad = 0.3;
    for (int n = 0; n < 4; ++n) add_tag(world, {0.8 + 0.8 * n, 1.5, 0.3 + 0.1 * n}, 40, 0.1);
    return lobes_of(world, bound_of(world, known_path())).wrong_share;
  };
  const double one = wrong({{0.0, 0.0, 0.0}}), two = wrong({{0.0, 0.0, 0.0}, {0.0, 0.5, 0.0}});
  EXPECT_GT(one, 0.2);
  EXPECT_LT(two, 0.5 * one);
}

TEST(Lobes, TooFewReadsHaveNone) {
  const World world = mirror_world(0.0, 4, 0.1);
  const Lobes lobes = lobes_of(world, bound_of(world, known_path()));
  EXPECT_EQ(lobes.tags[0].lobes, 0U);
  EXPECT_EQ(lobes.tags[0].wrong_probability, 0.0);
}

TEST(Lobes, TheSameSeedGivesTheSameFigures) {
  const World world = mirror_world(0.006, 40, 0.25);
  const Bound bound = bound_of(world, known_path());
  EXPECT_EQ(lobes_of(world, bound).rmse_m.value(), lobes_of(world, bound).rmse_m.value());
}

}  // namespace
}  // namespace rfmvo::bound
