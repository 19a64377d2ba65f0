// What a bound must do, whatever the scene: closed forms, monotony, and silence where nothing is seen.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/units.hpp"
#include "bound/bound_text.hpp"
#include "bound/information.hpp"
#include "unit/bound_world.hpp"

namespace rfmvo::bound {
namespace {

constexpr double kWave_rad_m = 4.0 * kPi * kFrequency_hz / kSpeedOfLight_m_s;

Settings known_path() {
  Settings settings;
  settings.known_path = true;
  settings.known_lever_arms = true;
  return settings;
}

double rmse_m(const World& world, const Settings& settings = {}) { return bound_of(world, settings).rmse_m.value(); }

// A short aperture, far broadside, level with the tag: phase = k (D + (x - x0)^2 / 2 D) + offset. Slope by x0:
// -k (x - x0) / D; by D: k (1 - (x - x0)^2 / 2 D^2), of which the offset takes the mean. Odd and even parts do
// not mix.
TEST(Bound, FarBroadsideBearingAndRangeAreTheClosedForm) {
  constexpr double kAperture_m = 1.0, kFar_m = 20.0, kWhite_rad = 0.1;
  World world = world_with(straight_pose, kAperture_m, {Eigen::Vector3d::Zero()});
  add_tag(world, {0.5 * kAperture_m, kFar_m, 0.0}, 60, kWhite_rad);
  double square = 0.0, quartic = 0.0;
  const double n = static_cast<double>(world.reads.size());
  for (const Read& read : world.reads) {
    const double x2 = std::pow(kSpeed_m_s * read.t_s - 0.5 * kAperture_m, 2);
    square += x2;
    quartic += x2 * x2;
  }
  const Bound bound = bound_of(world, known_path());
  const double bearing_m = kWhite_rad * kFar_m / (kWave_rad_m * std::sqrt(square));
  const double range_m = kWhite_rad * 2.0 * kFar_m * kFar_m / (kWave_rad_m * std::sqrt(quartic - square * square / n));
  const Eigen::Matrix3d& covariance = bound.tags[0].covariance_C_m2;
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), bearing_m, 2e-3 * bearing_m);  // aperture / range squared
  // The prior of 100 m does not matter to a range of 2 % of it.
  EXPECT_NEAR(std::sqrt(covariance(2, 2)), range_m, 5e-3 * range_m);
}

TEST(Bound, RepeatedWhiteReadsGainTheRootOfTheirNumber) {
  const auto with = [](int times) {
    World world = world_with(weaving_pose, 4.0, {{0.0, -0.5, 0.0}, {0.0, 0.5, 0.0}});
    add_tag(world, {1.8, 1.6, 0.3}, 30, 0.1);
    const std::vector<Read> once = world.reads;
    for (int i = 1; i < times; ++i) world.reads.insert(world.reads.end(), once.begin(), once.end());
    return rmse_m(world, known_path());
  };
  EXPECT_NEAR(with(4), 0.5 * with(1), 1e-4 * with(1));  // 1e-4: weak priors do not repeat
  EXPECT_NEAR(with(16), 0.25 * with(1), 1e-4 * with(1));
}

// Reads at the same place share the structured error: only its white part averages.
TEST(Bound, RepeatedReadsDoNotAverageTheStructuredError) {
  World once = stacked_world(), often = stacked_world();
  for (Read& read : once.reads) read.white_rad = 0.02;
  for (Read& read : often.reads) read.white_rad = 0.02;
  const std::vector<Read> reads = often.reads;
  for (int i = 1; i < 16; ++i) often.reads.insert(often.reads.end(), reads.begin(), reads.end());
  EXPECT_GT(rmse_m(often), 0.9 * rmse_m(once));
  EXPECT_LE(rmse_m(often), rmse_m(once) * (1.0 + 1e-9));
}

TEST(Bound, KnowingMoreIsNeverWorse) {
  const World world = stacked_world();
  const double nothing = rmse_m(world);
  Settings settings;
  settings.known_lever_arms = true;
  EXPECT_LE(rmse_m(world, settings), nothing);
  settings.known_path = true;
  EXPECT_LT(rmse_m(world, settings), nothing);
  settings = {};
  settings.free_offsets = true;
  EXPECT_GT(rmse_m(world, settings), nothing);
  settings = {};
  settings.time_offset_sigma_s = 0.02;
  EXPECT_GT(rmse_m(world, settings), nothing);
  World perfect = world;
  perfect.drift = *simulate::find_drift_class("PERFECT");
  EXPECT_LT(rmse_m(perfect), nothing);
}

TEST(Bound, MoreTagsAreNeverWorseForTheFirstAndForTheScale) {
  double last_m = 1e9, last_scale = 1e9;
  for (const std::size_t tags : {1U, 2U, 5U, 12U}) {
    const Bound bound = bound_of(stacked_world(tags), {});
    EXPECT_LE(*bound.tags[0].sigma_m, last_m * (1.0 + 1e-9)) << tags;
    EXPECT_LE(*bound.scale_relative, last_scale * (1.0 + 1e-9)) << tags;
    last_m = *bound.tags[0].sigma_m;
    last_scale = *bound.scale_relative;
  }
}

TEST(Bound, StraightLevelPathWithOneAntennaHasNone) {
  World world = world_with(straight_pose, 4.0, {Eigen::Vector3d::Zero()});
  world.drift = *simulate::find_drift_class("NOMINAL");
  world.lever_arm_sigma_m.setConstant(0.005);
  add_tag(world, {2.0, 1.5, 0.4}, 60, 0.05);
  for (const Settings& settings : {Settings{}, known_path()}) {
    const Bound bound = bound_of(world, settings);
    EXPECT_FALSE(bound.tags[0].sigma_m.has_value());
    EXPECT_FALSE(bound.rmse_m.has_value());
    EXPECT_EQ(bound.unbounded, 1U);
    EXPECT_TRUE(bound.tags[0].covariance_C_m2.allFinite());
  }
  const Bound bound = bound_of(world, {});
  const auto json = nlohmann::json::parse(to_json({bound, bound_of(world, known_path()), lobes_of(world, bound)}));
  EXPECT_TRUE(json.at("bound_rmse_m").is_null());
  EXPECT_TRUE(json.at("tags")[0].at("sigma_m").is_null());
}

TEST(Bound, DegenerateScenesHaveNoneWhereNothingIsSeen) {
  for (const char* scene : {"straight1ant", "purerotation", "standstill"}) {
    simulate::Options options;
    options.scene = scene;
    const Bound bound = bound_of(world_of(options).value(), {});
    EXPECT_EQ(bound.unbounded, bound.tags.size()) << scene;
    EXPECT_EQ(bound.scale_relative.has_value(), std::string(scene) == "straight1ant") << scene;
  }
}

TEST(Bound, TagWithoutReadsHasNoneAndTakesNothingFromTheOthers) {
  World world = stacked_world(3);
  const double before_m = rmse_m(world);
  add_tag(world, {1.0, 2.0, 0.0}, 0, 0.1);
  const Bound bound = bound_of(world, {});
  EXPECT_EQ(bound.unbounded, 1U);
  EXPECT_FALSE(bound.tags[3].sigma_m.has_value());
  EXPECT_NEAR(*bound.rmse_m, before_m, 1e-9);
}

TEST(Bound, FinerKnotsChangeNothingThatMatters) {
  const World world = stacked_world();
  Settings fine;
  fine.knot_spacing_m = 0.05;
  EXPECT_NEAR(rmse_m(world), rmse_m(world, fine), 0.01 * rmse_m(world));
}

TEST(Bound, ErrorCovarianceIsTheSimulatorsKernelPlusWhite) {
  const std::vector<Read> chain{{0.0, 0, 0, kFrequency_hz, 0.1, 0.0}, {0.1, 0, 0, kFrequency_hz, 0.2, 0.08}};
  const Eigen::MatrixXd gaussian = error_covariance(chain, {0.3, 0.08, false});
  EXPECT_NEAR(gaussian(0, 0), 0.09 + 0.01, 1e-15);
  EXPECT_NEAR(gaussian(1, 1), 0.09 + 0.04, 1e-15);
  EXPECT_NEAR(gaussian(0, 1), 0.09 * std::exp(-0.5), 1e-15);
  EXPECT_NEAR(error_covariance(chain, {0.3, 0.08, true})(1, 0), 0.09 * std::exp(-1.0), 1e-15);
}

TEST(Bound, ReadsOfAWorldAreThoseOfTheRun) {
  simulate::Options options;
  options.scene = "S3";
  options.frames = false;
  std::vector<TagRead> reads;
  const auto truth = simulate::simulate(options, [&](const Event& event) -> Status {
    if (const auto* read = std::get_if<TagRead>(&event)) reads.push_back(*read);
    return Done{};
  });
  ASSERT_TRUE(truth.ok());
  const World world = world_of(options).value();
  ASSERT_EQ(world.reads.size(), reads.size());
  for (std::size_t i = 0; i < reads.size(); ++i) {
    EXPECT_EQ(world.tags[world.reads[i].tag].epc, reads[i].epc);
    EXPECT_EQ(world.reads[i].port + 1, reads[i].port);
    EXPECT_NEAR(world.reads[i].frequency_hz, reads[i].frequency_hz, 0.5);
  }
  options.frame_gap_s = 1.0;
  EXPECT_FALSE(world_of(options).ok());
}

TEST(Bound, OfS3IsOfTheExpectedOrder) {
  simulate::Options options;
  options.scene = "S3";
  // Reads as dense as those of the published figures (docs/accuracy.md), path known: 2.6 cm.
  const World dense = world_of(options, {.white_rad = 0.03, .read_spacing_m = 0.05}).value();
  Settings settings;
  settings.known_path = true;
  EXPECT_NEAR(rmse_m(dense, settings), 0.026, 0.003);
  EXPECT_GT(rmse_m(world_of(options).value()), rmse_m(dense));
}

}  // namespace
}  // namespace rfmvo::bound
