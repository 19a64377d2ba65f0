#include <gtest/gtest.h>

#include "estimator/port_offset_scan.hpp"
#include "estimator/signal_strength.hpp"
#include "rf/phase.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::kPi;
using joint_scene::make_world;
using joint_scene::World;

// Antennas look to the cart's left: against the camera's x.
BeamModel left_looking() {
  BeamModel beams;
  beams.boresight_C = {-Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX()};
  return beams;
}

// RSSI by the radar equation and a cosine pattern, written out once more.
void set_rssi(World& w, const BeamModel& beams, std::size_t tag) {
  const double n = std::log(0.5) / std::log(std::cos(beams.half_power_rad));
  for (JointRead& read : w.problem.reads[tag]) {
    const Eigen::Vector3d ray = w.truth.tags[tag].p_W_X - read.p_W_A;
    const Eigen::Vector3d left = -read.geometry.R_W_C.col(0);
    const double cosine = std::max(0.05, ray.normalized().dot(left));
    read.rssi_db = -35.0 + std::max(-30.0, 20.0 * n * std::log10(cosine)) - 40.0 * std::log10(ray.norm());
  }
}

TEST(SignalStrength, PatternLosesThreeDecibelEachWayAtHalfPower) {
  EXPECT_NEAR(two_way_pattern_db(std::cos(0.61), 0.61), -20.0 * std::log10(2.0), 1e-9);
  EXPECT_EQ(two_way_pattern_db(1.0, 0.61), 0.0);
  EXPECT_EQ(two_way_pattern_db(-0.5, 0.61), -30.0);
}

TEST(SignalStrength, IsLikeliestAboutTheTag) {
  World w = make_world(1, 30, 1.0);
  const BeamModel beams = left_looking();
  set_rssi(w, beams, 0);
  const Eigen::Vector3d tag = w.truth.tags[0].p_W_X;
  const double there = signal_strength_cost(w.problem.reads[0], w.truth, beams, tag);
  EXPECT_NEAR(there, 0.0, 1e-6);
  for (const Eigen::Vector3d& off : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.8, 0, 0), Eigen::Vector3d(0, -3.8, 0)})
    EXPECT_GT(signal_strength_cost(w.problem.reads[0], w.truth, beams, tag + off), there + 0.3) << off.transpose();
}

TEST(SignalStrength, ATagsOwnSensitivityDoesNotMatter) {
  World w = make_world(1, 20, 1.0);
  const BeamModel beams = left_looking();
  set_rssi(w, beams, 0);
  const Eigen::Vector3d place = w.truth.tags[0].p_W_X + Eigen::Vector3d(0.3, 0.2, 0.4);
  const double before = signal_strength_cost(w.problem.reads[0], w.truth, beams, place);
  for (JointRead& read : w.problem.reads[0]) read.rssi_db -= 11.0;
  EXPECT_NEAR(signal_strength_cost(w.problem.reads[0], w.truth, beams, place), before, 1e-9);
}

// The constant that the RSSI was made with, wherever the tag is; and a site of such tags makes places unlikely at which
// it would have to be another sort of tag.
TEST(SignalStrength, WhatTagsOfASiteAreLikeTellsHowFarOneIs) {
  World w = make_world(1, 30, 1.0);
  BeamModel beams = left_looking();
  set_rssi(w, beams, 0);
  const Eigen::Vector3d tag = w.truth.tags[0].p_W_X, far = tag + Eigen::Vector3d(-4.0, 0.0, 0.0);
  const auto cost = [&](const Eigen::Vector3d& p) { return fit_signal_strength(w.problem.reads[0], w.truth, beams, p); };
  EXPECT_NEAR(cost(tag).level_db, -35.0, 1e-6);
  const double before = cost(far).cost - cost(tag).cost;
  beams.level_db = -35.0;
  EXPECT_NEAR(cost(tag).cost, 0.0, 1e-6);
  const double excess_db = cost(far).level_db + 35.0;
  EXPECT_GT(excess_db, 12.0);
  EXPECT_GT(cost(far).cost - cost(tag).cost, before + 1.5);
  // Where the site is like that, the far place is as likely as it was.
  beams.level_db = -35.0 + excess_db;
  EXPECT_LT(cost(far).cost - cost(tag).cost, before);
}

TEST(SignalStrength, ReadsAtOnePlaceCountOnce) {
  World w = make_world(1, 20, 1.0);
  const BeamModel beams = left_looking();
  set_rssi(w, beams, 0);
  const Eigen::Vector3d place = w.truth.tags[0].p_W_X + Eigen::Vector3d(0.3, 0.2, 0.4);
  const double before = signal_strength_cost(w.problem.reads[0], w.truth, beams, place);
  std::vector<JointRead> twice;
  for (const JointRead& read : w.problem.reads[0]) twice.insert(twice.end(), 2, read);
  EXPECT_NEAR(signal_strength_cost(twice, w.truth, beams, place), before, 1e-9);
}

std::vector<TagPlaces> places_with_decoys(const World& w) {
  std::vector<TagPlaces> tags;
  for (std::size_t t = 0; t < w.problem.reads.size(); ++t) {
    const Eigen::Vector3d tag = w.truth.tags[t].p_W_X;
    tags.push_back(phasors_at(w.problem.reads[t], w.truth,
                              {tag + Eigen::Vector3d(0.1, 0.0, 0.3), tag, tag - Eigen::Vector3d(0.0, 0.1, 0.25)}));
  }
  return tags;
}

TEST(PortOffsetScan, FindsTheOffsetsAndEveryTagAmongItsPlaces) {
  const World w = make_world(4, 25, 1.2);
  const std::vector<TagPlaces> tags = places_with_decoys(w);
  const auto found = scan_port_offsets(tags, 2, 3);
  ASSERT_FALSE(found.empty());
  // Half a step of the scan, 5 degrees, and the parabola of the maximum.
  EXPECT_LT(std::abs(wrap_rad(found[0].offset_rad[1] - w.truth.ports[1].offset_rad)), kPi / 36.0 + 1e-9);
  for (const TagPlaces& tag : tags) EXPECT_EQ(best_place(tag, found[0].offset_rad), 1U);
}

TEST(PortOffsetScan, TurnsWithThePhasesOfAPort) {
  World w = make_world(3, 20, 1.2);
  const double before = scan_port_offsets(places_with_decoys(w), 2, 1)[0].offset_rad[1];
  const double turn = 10.0 * kPi / 36.0;  // five steps
  for (auto& reads : w.problem.reads)
    for (JointRead& read : reads)
      if (read.port == 1) read.phase_rad += turn;
  EXPECT_NEAR(wrap_rad(scan_port_offsets(places_with_decoys(w), 2, 1)[0].offset_rad[1] - before - turn), 0.0, 1e-9);
}

TEST(PortOffsetScan, OnePortHasNothingToScan) {
  World w = make_world(2, 20, 1.2);
  w.truth.ports.resize(1);
  for (auto& reads : w.problem.reads) std::erase_if(reads, [](const JointRead& r) { return r.port == 1; });
  const auto found = scan_port_offsets(places_with_decoys(w), 1, 3);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].offset_rad, std::vector<double>{0.0});
}

}  // namespace
}  // namespace rfmvo
