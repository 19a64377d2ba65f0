// The figures of `rfmvo vo` against paths whose errors are known by construction.
#include <gtest/gtest.h>

#include <cmath>

#include "odometry/path_figures.hpp"
#include "simulate/random.hpp"

namespace rfmvo::odometry {
namespace {

constexpr double kRate_hz = 30.0;
constexpr double kUnit_m = 1.7;  // of V

struct World {
  std::vector<PathPose> path;
  std::vector<simulate::TruePose> truth;
};

DeviceTime frame_time(int i) { return {1'700'000'000'000'000'000 + std::llround(i * 1e9 / kRate_hz)}; }

// A winding path in V, and the same in W: turned, shifted, kUnit_m times as large.
World perfect(int frames) {
  World world;
  const Rigid3 T_W_V{so3_exp({0.3, -0.8, 1.1}), {4.0, -2.0, 0.5}};
  for (int i = 0; i < frames; ++i) {
    const double t = i / kRate_hz;
    const UnscaledPose pose{so3_exp({0.02 * std::sin(t), 0.3 * std::sin(0.5 * t), 0.0}),
                            {0.5 * t, 0.1 * std::sin(t), 0.2 * std::cos(0.7 * t)}};
    world.path.push_back({frame_time(i), 0, pose, 1e-6 * Eigen::Matrix<double, 6, 6>::Identity()});
    world.truth.push_back({frame_time(i), T_W_V * Rigid3{pose.R_V_C, kUnit_m * pose.p_V_C}});
  }
  return world;
}

TEST(PathFigures, APerfectPathHasNoErrorButItsScale) {
  const World world = perfect(300);
  const auto f = path_figures(world.path, world.truth);
  ASSERT_TRUE(f.has_value());
  constexpr double kRounding = 1e-9;
  EXPECT_EQ(f->poses, 300);
  EXPECT_NEAR(f->scale_m_per_unit, kUnit_m, kRounding);
  EXPECT_LT(f->ate_sim3_m, kRounding);
  EXPECT_LT(f->rpe_second_m, kRounding);
  EXPECT_LT(f->step_noise_m, kRounding);
  ASSERT_TRUE(f->half_scale_median.has_value());
  EXPECT_LT(*f->half_scale_median, kRounding);
  EXPECT_GT(f->ate_se3_m, 0.3);  // without the scale it cannot fit
  EXPECT_LT(*f->nees, kRounding);
}

TEST(PathFigures, StepNoiseIsRootTwoOfWhitePositionNoisePerAxis) {
  World world = perfect(3000);
  simulate::Random random(3, "noise");
  constexpr double kSigma = 0.001;
  for (auto& p : world.path)
    p.T_V_C.p_V_C += kSigma * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
  const auto f = path_figures(world.path, world.truth);
  // 1000 steps of 3 axes: the estimate of a standard deviation scatters by 1 / sqrt(2 * 3000) = 1.3 %.
  EXPECT_NEAR(f->step_noise_m, std::sqrt(2.0) * kSigma * kUnit_m, 0.06 * kSigma * kUnit_m);
  EXPECT_NEAR(f->ate_sim3_m, std::sqrt(3.0) * kSigma * kUnit_m, 0.1 * kSigma * kUnit_m);
}

// A scale that grows by 1 % per second.
TEST(PathFigures, HalfScalesSeeADriftOfTheScale) {
  World world = perfect(360);
  constexpr double kDrift_per_s = 0.01;
  UnscaledPose before = world.path[0].T_V_C;
  Eigen::Vector3d p = before.p_V_C;
  for (std::size_t i = 1; i < world.path.size(); ++i) {
    const UnscaledPose now = world.path[i].T_V_C;
    p += std::exp(kDrift_per_s * static_cast<double>(i) / kRate_hz) * (now.p_V_C - before.p_V_C);
    before = now;
    world.path[i].T_V_C.p_V_C = p;
  }
  const auto f = path_figures(world.path, world.truth);
  // The middles of the halves are 3 s apart.
  EXPECT_NEAR(*f->half_scale_median, 3.0 * kDrift_per_s, 0.1 * 3.0 * kDrift_per_s);
}

TEST(PathFigures, SegmentsAreAlignedEachForItself) {
  World world = perfect(300);
  for (std::size_t i = 150; i < 300; ++i) {
    world.path[i].segment = 1;
    world.path[i].T_V_C.p_V_C *= 3.0;
  }
  EXPECT_LT(path_figures(world.path, world.truth)->ate_sim3_m, 1e-9);
  for (auto& p : world.path) p.segment = 0;
  EXPECT_GT(path_figures(world.path, world.truth)->ate_sim3_m, 0.1);
}

TEST(PathFigures, NeesIsOneIfTheCovarianceIsRight) {
  World world = perfect(9000);
  simulate::Random random(5, "walk");
  constexpr double kStep = 1e-4;  // of rotation (rad) and translation, each frame
  Rigid3 walked{world.path[0].T_V_C.R_V_C, world.path[0].T_V_C.p_V_C};
  for (std::size_t i = 1; i < world.path.size(); ++i) {
    const Rigid3 from = Rigid3{world.truth[i - 1].T_W_C.R, world.truth[i - 1].T_W_C.t / kUnit_m};
    const Rigid3 to = Rigid3{world.truth[i].T_W_C.R, world.truth[i].T_W_C.t / kUnit_m};
    Eigen::Vector3d w, v;
    for (int k = 0; k < 3; ++k) w[k] = kStep * random.normal(), v[k] = kStep * random.normal();
    walked = walked * (from.inverse() * to) * Rigid3{so3_exp(w), v};
    world.path[i].T_V_C = {walked.R, walked.t};
    world.path[i].motion_covariance = kStep * kStep * Eigen::Matrix<double, 6, 6>::Identity();
  }
  // The long walk bends; scale is taken from the whole. Seconds are compared one by one: 300 independent ones of 6
  // degrees of freedom scatter by sqrt(2 / 1800) = 3 %.
  EXPECT_NEAR(*path_figures(world.path, world.truth)->nees, 1.0, 0.15);
}

TEST(PathFigures, NothingToSayAboutAPathThatDoesNotMoveOrHasNoTruth) {
  World world = perfect(100);
  EXPECT_FALSE(path_figures(world.path, {}).has_value());
  EXPECT_FALSE(path_figures({}, world.truth).has_value());
  for (auto& p : world.path) p.T_V_C = {};
  EXPECT_FALSE(path_figures(world.path, world.truth).has_value());
}

}  // namespace
}  // namespace rfmvo::odometry
