// What goes wrong on request, and that nothing else changes with it.
#include <gtest/gtest.h>

#include <cmath>

#include "base/units.hpp"
#include "simulate/scene.hpp"

namespace rfmvo::simulate {
namespace {

struct StressedRun {
  std::vector<TagRead> reads;
  std::vector<CameraPose> poses;
  Truth truth;
};

StressedRun run(const Options& options) {
  StressedRun r;
  auto truth = simulate(options, [&](const Event& event) -> Status {
    if (const auto* read = std::get_if<TagRead>(&event)) r.reads.push_back(*read);
    if (const auto* pose = std::get_if<CameraPose>(&event)) r.poses.push_back(*pose);
    return Done{};
  });
  EXPECT_TRUE(truth.ok());
  if (truth.ok()) r.truth = std::move(truth).value();
  return r;
}

Options options_of(const char* scene) {
  Options options;
  options.scene = scene;
  options.frames = false;
  return options;
}

std::string error_of(const Options& options) {
  const auto result = simulate(options, [](const Event&) -> Status { return Done{}; });
  return result.ok() ? "" : result.error().text();
}

double turn_between(Phase a, Phase b) {
  return std::abs(std::remainder((a.turn_q16 - b.turn_q16) * kTwoPi / 65536.0, kTwoPi));
}

// Share of the reads whose phase differs by more than the resolution, and the mean difference of these.
struct Difference {
  double share = 0.0, mean_rad = 0.0;
};
Difference difference(const StressedRun& a, const StressedRun& b) {
  Difference d;
  EXPECT_EQ(a.reads.size(), b.reads.size());
  for (std::size_t i = 0; i < std::min(a.reads.size(), b.reads.size()); ++i) {
    EXPECT_EQ(a.reads[i].time, b.reads[i].time);
    EXPECT_EQ(a.reads[i].rssi_cdbm, b.reads[i].rssi_cdbm);
    const double rad = turn_between(a.reads[i].phase, b.reads[i].phase);
    if (rad < 0.005) continue;
    d.share += 1.0;
    d.mean_rad += rad;
  }
  d.mean_rad /= std::max(d.share, 1.0);
  d.share /= static_cast<double>(a.reads.size());
  return d;
}

TEST(SimulateStress, OutliersReplaceTheirShareOfPhasesByAnythingAndNothingElse) {
  Options options = options_of("S3");
  const StressedRun clean = run(options);
  options.outlier_share = 0.3;
  const Difference d = difference(clean, run(options));
  EXPECT_NEAR(d.share, 0.3, 4.0 * std::sqrt(0.3 * 0.7 / static_cast<double>(clean.reads.size())));
  EXPECT_NEAR(d.mean_rad, kPi / 2.0, 0.3);  // mean of |wrapped uniform|
}

TEST(SimulateStress, FlipsTurnTheirShareByPi) {
  Options options = options_of("tags300");
  options.flip_share = 0.0;
  const StressedRun clean = run(options);
  options.flip_share = 0.05;
  const Difference d = difference(clean, run(options));
  // From the first read of a tag on. Bursts of 5 reads on average: 4 sigma of a fifth as many independent draws.
  EXPECT_NEAR(d.share, 0.05, 4.0 * std::sqrt(5.0 * 0.05 * 0.95 / static_cast<double>(clean.reads.size())));
  EXPECT_NEAR(d.mean_rad, kPi, 0.01);
}

TEST(SimulateStress, FrameGapTakesThePosesOfItsTimeAndStartsANewSegment) {
  Options options = options_of("S3");
  const StressedRun whole = run(options);
  options.frame_gap_s = 1.0;
  const StressedRun gap = run(options);
  EXPECT_EQ(difference(whole, gap).share, 0.0);
  EXPECT_NEAR(static_cast<double>(whole.poses.size() - gap.poses.size()), 30.0, 1.0);
  std::size_t changes = 0;
  for (std::size_t k = 1; k < gap.poses.size(); ++k) {
    if (gap.poses[k].segment == gap.poses[k - 1].segment) {
      EXPECT_LT((gap.poses[k].time - gap.poses[k - 1].time).seconds(), 0.04);
      continue;
    }
    ++changes;
    EXPECT_NEAR((gap.poses[k].time - gap.poses[k - 1].time).seconds(), 1.0, 0.04);
    EXPECT_LT(gap.poses[k].T_V_C.p_V_C.norm(), 1e-9);  // V begins anew
  }
  EXPECT_EQ(changes, 1U);
  EXPECT_EQ(gap.truth.trajectory.size(), whole.truth.trajectory.size());
}

TEST(SimulateStress, StructuredStrengthScalesThePhaseErrorOnly) {
  Options options = options_of("S3");
  options.structured_rad = 0.3;
  EXPECT_EQ(difference(run(options_of("S3")), run(options)).share, 0.0);  // the scene's own
  options.structured_rad = 0.45;
  EXPECT_GT(difference(run(options_of("S3")), run(options)).share, 0.8);
}

TEST(SimulateStress, AnyNumberOfTagsWhereTheSceneLeavesItOpen) {
  Options options = options_of("S6");
  options.tags = 300;
  EXPECT_EQ(run(options).truth.tags.size(), 300U);
  options.scene = "aisle";
  EXPECT_NE(error_of(options).find("--tags"), std::string::npos);
}

TEST(SimulateStress, WhatASceneCannotDoIsAnErrorThatNamesTheOption) {
  Options options = options_of("aisle");
  options.structured_rad = 0.45;
  EXPECT_NE(error_of(options).find("--structured-rad"), std::string::npos);
  options = options_of("S3");
  options.frame_gap_s = 6.0;
  EXPECT_NE(error_of(options).find("--frame-gap-s"), std::string::npos);
}

TEST(SimulateStress, DegenerateScenesAreKnownAsSuch) {
  for (const char* scene :
       {"straight", "straight1ant", "oneantenna", "stackedmirror", "purerotation", "standstill", "onetag"})
    EXPECT_TRUE(is_degenerate_scene(scene)) << scene;
  for (const char* scene : {"S3", "S6", "tags300", "wall", "aisle"}) EXPECT_FALSE(is_degenerate_scene(scene)) << scene;
  const StressedRun one = run(options_of("oneantenna"));
  EXPECT_EQ(one.truth.calibration.antennas.size(), 1U);
  double weave_m = 0.0;
  for (const TruePose& pose : one.truth.trajectory) weave_m = std::max(weave_m, std::abs(pose.T_W_C.t.y()));
  EXPECT_GT(weave_m, 0.1);
}

}  // namespace
}  // namespace rfmvo::simulate
