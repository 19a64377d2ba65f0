// Two maps of the same tags laid over each other, and a path continued behind a gap.
#include <gtest/gtest.h>

#include "estimator/odometry_path.hpp"
#include "estimator/segment_alignment.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::random_rotation;
using joint_scene::random_vector;

struct Maps {
  std::vector<SharedTag> tags;
  ExpectedStart start;
  Rigid3 T_first_second;
};

// Tags about a camera that stands at the same place in both maps, but the second map has other axes. The camera is
// expected where it truly is, but for `surprise`.
Maps make_maps(int count, const Rigid3& surprise, std::mt19937& random) {
  Maps maps;
  maps.T_first_second = {random_rotation(random), random_vector(random, 5.0)};
  const Rigid3 T_first_C{random_rotation(random), random_vector(random, 2.0)};
  for (int t = 0; t < count; ++t) {
    const Eigen::Vector3d p = T_first_C * random_vector(random, 2.0);
    maps.tags.push_back({{{p, 1.0}}, {{maps.T_first_second.inverse() * p, 1.0}}});
  }
  maps.start = {T_first_C * surprise, maps.T_first_second.inverse() * T_first_C};
  return maps;
}

double apart(const Rigid3& a, const Rigid3& b, double at_m = 2.0) {
  double most = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d p = at_m * Eigen::Vector3d::Unit(axis);
    most = std::max(most, (a * p - b * p).norm());
  }
  return most;
}

Rigid3 some_surprise(std::mt19937& random) {
  return {so3_exp(random_vector(random, 0.1)), random_vector(random, 0.25)};
}

TEST(SegmentAlignment, IsExactWhateverTheFramesAre) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const Maps maps = make_maps(8, some_surprise(random), random);
    const auto found = align_maps(maps.tags, maps.start, 0.1);
    ASSERT_TRUE(found);
    // The expected start pulls a little: 8 tags at 0.1 m against one camera at 0.3 m.
    EXPECT_LT(apart(found->T_first_second, maps.T_first_second), 0.04);
    EXPECT_GT(found->tags, 7.5);
  }
}

TEST(SegmentAlignment, TrueStartIsKept) {
  std::mt19937 random(6);
  const Maps maps = make_maps(5, {}, random);
  const auto found = align_maps(maps.tags, maps.start, 0.1);
  ASSERT_TRUE(found);
  EXPECT_LT(apart(found->T_first_second, maps.T_first_second), 1e-9);
  EXPECT_LT(found->residual_m, 1e-9);
}

// A mirror place of each tag, as likely as the true one: only the true ones agree under one rigid motion.
TEST(SegmentAlignment, MirrorPlacesAndMovedTagsDoNotMislead) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 20; ++trial) {
    Maps maps = make_maps(12, some_surprise(random), random);
    for (std::size_t t = 0; t < maps.tags.size(); ++t) {
      for (auto* places : {&maps.tags[t].first, &maps.tags[t].second}) {
        places->front().share = 0.5;
        places->push_back({places->front().p_m + random_rotation(random) * Eigen::Vector3d::UnitX(), 0.5});
        if (t % 2 == 0) std::swap(places->front(), places->back());
      }
      if (t % 6 == 0) maps.tags[t].second = {{random_vector(random, 4.0), 1.0}};
    }
    const auto found = align_maps(maps.tags, maps.start, 0.1);
    ASSERT_TRUE(found);
    EXPECT_LT(apart(found->T_first_second, maps.T_first_second), 0.1);
  }
}

TEST(SegmentAlignment, TwoTagsOrTagsThatAllMovedSayNothing) {
  std::mt19937 random(8);
  EXPECT_FALSE(align_maps({}, make_maps(0, {}, random).start, 0.1));
  const Maps two = make_maps(2, {}, random);
  EXPECT_FALSE(align_maps(two.tags, two.start, 0.1));
  Maps moved = make_maps(6, {}, random);
  for (SharedTag& tag : moved.tags) tag.second.front().p_m = random_vector(random, 50.0);
  EXPECT_FALSE(align_maps(moved.tags, moved.start, 0.1));
}

// --- a path behind a gap ---

CameraPose pose_on(const Rigid3& T_W_C, double unit_m, double seconds) {
  CameraPose pose;
  pose.time = {std::llround(seconds * 1e9)};
  pose.status = VoStatus::kTracking;
  pose.T_V_C = {T_W_C.R, T_W_C.t / unit_m};
  return pose;
}

Rigid3 drive(double seconds) {
  return {so3_exp({0.0, 0.0, 0.2 * seconds}), {0.6 * seconds, 0.1 * seconds * seconds, 0.0}};
}

// Each piece in a V of its own (axes of its first camera, own unit); the second one joined as it truly lies.
struct Joined {
  OdometryPath path{drive(0.0).R};
  PathJoint joint;
};
constexpr double kFirstUnit_m = 1.7, kSecondUnit_m = 0.6, kLost_s = 2.0, kFound_s = 3.0, kEnd_s = 6.0;

Joined joined_path() {
  Joined j;
  OdometryPath second(Eigen::Quaterniond::Identity());
  for (int i = 0; 0.05 * i <= kEnd_s; ++i) {
    const double t = 0.05 * i;
    if (t <= kLost_s) j.path.add(pose_on(drive(t), kFirstUnit_m, t));
    if (t >= kFound_s) second.add(pose_on(drive(kFound_s).inverse() * drive(t), kSecondUnit_m, t));
  }
  j.joint = {kSecondUnit_m / kFirstUnit_m, drive(kFound_s).R, drive(kFound_s).t / kFirstUnit_m};
  j.path.append(second, j.joint);
  return j;
}

TEST(JoinedPath, IsThePathAsItWasDriven) {
  const Joined j = joined_path();
  for (const PathPose& pose : j.path.poses()) {
    const Rigid3 truth = drive(static_cast<double>(pose.time.ns) * 1e-9);
    EXPECT_NEAR((kFirstUnit_m * pose.n_W - truth.t).norm(), 0.0, 1e-9);
    EXPECT_LT(pose.R_W_C.angularDistance(truth.R), 1e-7);
  }
}

TEST(JoinedPath, GoesOnWithFurtherPosesOfTheLaterOdometry) {
  Joined j = joined_path();
  const double t = kEnd_s + 0.5;
  j.path.add(pose_on(drive(kFound_s).inverse() * drive(t), kSecondUnit_m, t));
  EXPECT_NEAR((kFirstUnit_m * j.path.poses().back().n_W - drive(t).t).norm(), 0.0, 1e-9);
  const auto later = j.path.geometry({drive(0.0).R, {0.0, 0.0, 0.0}}, {1.0, 0.0, 0.0}, {}, 1);
  EXPECT_NEAR((kFirstUnit_m * later.n_W - drive(kFound_s).t).norm(), 0.0, 1e-9);
  EXPECT_NEAR(kFirstUnit_m * later.velocity_W.norm(), kSecondUnit_m, 1e-9);
}

TEST(JoinedPath, OneIntervalIsTheGapAndNoPoseLiesInIt) {
  const Joined j = joined_path();
  for (const double spacing_V : {0.07, 0.3, 1.1}) {
    const auto intervals = j.path.intervals(spacing_V);
    int gaps = 0, gap = 0;
    Eigen::Vector3d driven = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < intervals.size(); ++k) {
      driven += intervals[k].step_W;
      if (!intervals[k].gap) continue;
      ++gaps;
      gap = static_cast<int>(k);
    }
    ASSERT_EQ(gaps, 1);
    const Eigen::Vector3d step = drive(kFound_s).t - drive(kLost_s).t;
    EXPECT_NEAR((kFirstUnit_m * driven - (drive(kEnd_s).t - step)).norm(), 0.0, 1e-9);
    for (const PathPose& pose : j.path.poses()) {
      const KnotPlace place = j.path.place(pose.arc_V, spacing_V);
      const bool later = static_cast<double>(pose.time.ns) * 1e-9 > 0.5 * (kLost_s + kFound_s);
      EXPECT_EQ(j.path.piece_of(pose.arc_V), later ? 1U : 0U);
      EXPECT_NE(place.knot, gap);
      EXPECT_EQ(place.knot > gap, later);
      EXPECT_LT(static_cast<std::size_t>(place.knot), intervals.size());
    }
  }
}

}  // namespace
}  // namespace rfmvo
