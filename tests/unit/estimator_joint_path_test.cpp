// The odometry's path and knots, the camera's pose at each read, and the electrical length from hops.
#include <gtest/gtest.h>

#include "estimator/electrical_length.hpp"
#include "estimator/odometry_path.hpp"
#include "estimator/sampling_synchronization.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::random_rotation;
using joint_scene::random_vector;

DeviceTime at(double seconds) { return {std::llround(seconds * 1e9)}; }

CameraPose pose_at(double seconds, const Eigen::Vector3d& p_V_C,
                   const Eigen::Quaterniond& R = Eigen::Quaterniond::Identity()) {
  CameraPose pose;
  pose.time = at(seconds);
  pose.status = VoStatus::kTracking;
  pose.T_V_C = {R, p_V_C};
  return pose;
}

TagRead read_at(double seconds, std::uint8_t port = 1) {
  TagRead read;
  read.time = at(seconds);
  read.port = port;
  return read;
}

// --- electrical length ---

// One (tag, port) chain: hops every 0.2 s over the channels, the cart moving, the phase with its noise.
std::vector<TimedPhase> hopping_chain(double cable_m, double air_m, double noise_rad, std::mt19937& random,
                                      bool hops = true) {
  std::vector<TimedPhase> chain;
  std::normal_distribution<double> normal(0.0, noise_rad);
  std::uniform_int_distribution<int> channel(0, 15);
  const double offset_rad = 0.4 * channel(random);
  double frequency_hz = 920e6;
  for (int i = 0; i < 200; ++i) {
    if (hops && i % 4 == 0) frequency_hz = 920e6 + 0.25e6 * channel(random);
    const double time_s = 0.05 * i;
    const double distance_m = air_m + 0.3 * std::sin(0.7 * time_s);  // up to 0.2 m/s, towards and away
    const double term = joint_scene::frequency_term_rad_m(frequency_hz);
    const double phase =
        joint_scene::wavenumber_rad_m(920e6) * distance_m + term * (distance_m + cable_m) + offset_rad + normal(random);
    chain.push_back({time_s, std::remainder(phase, 2.0 * joint_scene::kPi), term});
  }
  return chain;
}

TEST(ElectricalLength, IsRecoveredFromHopsInMotionAndNoise) {
  // The wave also travels to the tag, 1.0 to 2.5 m: hops measure the sum. 9.5 m are 8 m of cable and 1.5 m of air.
  std::mt19937 random(71);
  std::vector<std::vector<TimedPhase>> chains;
  for (int t = 0; t < 6; ++t) chains.push_back(hopping_chain(8.0, 1.5, 0.3, random));
  const ElectricalLength found = electrical_length_from_hops(chains);
  // 300 hops, each a difference of two phases of 0.3 rad and up to 0.4 rad of motion: 0.6 rad at most. Terms differ by
  // 1.6 MHz rms: 0.067 rad per metre. 0.6 / (0.067 sqrt(300)) = 0.5 m; three of them.
  EXPECT_NEAR(found.length_m, 9.5, 1.5);
  // exp(-(0.6)^2 / 2) = 0.84 at worst, less the hops that miss.
  EXPECT_GT(found.coherence, 0.75);
  EXPECT_LE(found.coherence, 1.0);
}

TEST(ElectricalLength, OfSilentReadsAtStandstillIsExactToAStep) {
  std::vector<TimedPhase> chain;
  for (int i = 0; i < 50; ++i) {
    const double term = joint_scene::frequency_term_rad_m(920e6 + 0.5e6 * ((7 * i) % 9));
    chain.push_back({0.05 * i, std::remainder(0.3 + term * 9.5, 2.0 * joint_scene::kPi), term});
  }
  const ElectricalLength found = electrical_length_from_hops({chain});
  EXPECT_NEAR(found.length_m, 9.5, 0.1);
  EXPECT_NEAR(found.coherence, 1.0, 1e-3);
}

TEST(ElectricalLength, DoesNotMindTheOffsetsOfTagsNorHopsFarApartInTime) {
  std::mt19937 random(73);
  auto chain = hopping_chain(8.0, 1.5, 0.1, random);
  const ElectricalLength before = electrical_length_from_hops({chain});
  for (TimedPhase& r : chain) r.phase_rad = std::remainder(r.phase_rad + 2.0, 2.0 * joint_scene::kPi);
  EXPECT_NEAR(electrical_length_from_hops({chain}).coherence, before.coherence, 1e-12);
  for (std::size_t i = 0; i < chain.size(); ++i) chain[i].time_s = static_cast<double>(i);  // 1 s between reads
  EXPECT_EQ(electrical_length_from_hops({chain}).coherence, 0.0);
}

// 100 times 40 hops of random phases: one length or another always seems to explain them a little.
TEST(ElectricalLength, ThatNoiseMadeUpIsNotSignificant) {
  std::mt19937 random(75);
  std::uniform_real_distribution<double> any(-joint_scene::kPi, joint_scene::kPi);
  std::uniform_int_distribution<int> channel(0, 15);
  int claimed = 0;
  for (int run = 0; run < 100; ++run) {
    std::vector<TimedPhase> chain;
    for (int i = 0; i < 40; ++i)
      chain.push_back({0.05 * i, any(random), joint_scene::frequency_term_rad_m(920e6 + 0.25e6 * channel(random))});
    claimed += electrical_length_from_hops({chain}).significance > 4.0 ? 1 : 0;
  }
  EXPECT_EQ(claimed, 0);
  EXPECT_GT(electrical_length_from_hops({hopping_chain(8.0, 1.5, 0.3, random)}).significance, 4.0);
}

TEST(ElectricalLength, IsNotClaimedWithoutHops) {
  std::mt19937 random(72);
  EXPECT_EQ(electrical_length_from_hops({}).coherence, 0.0);
  EXPECT_EQ(electrical_length_from_hops({{}, {{0.0, 1.0, 0.1}}}).coherence, 0.0);
  EXPECT_EQ(electrical_length_from_hops({hopping_chain(8.0, 1.5, 0.3, random, false)}).coherence, 0.0);
}

// --- path and knots ---

TEST(OdometryPath, StartsAtTheOriginWithTheGivenOrientation) {
  std::mt19937 random(74);
  const Eigen::Quaterniond R_W_C0 = random_rotation(random);
  OdometryPath path(R_W_C0);
  const CameraPose first = pose_at(1.0, random_vector(random, 3.0), random_rotation(random));
  const CameraPose second = pose_at(1.1, random_vector(random, 3.0), random_rotation(random));
  path.add(first);
  path.add(second);
  EXPECT_EQ(path.poses()[0].n_W, Eigen::Vector3d::Zero());
  EXPECT_NEAR(path.poses()[0].R_W_C.angularDistance(R_W_C0), 0.0, 1e-7);
  EXPECT_EQ(path.poses()[0].arc_V, 0.0);
  // Seen from the first camera, the second one stands where the odometry has it.
  const Eigen::Vector3d expected = R_W_C0 * (first.T_V_C.R_V_C.conjugate() * (second.T_V_C.p_V_C - first.T_V_C.p_V_C));
  EXPECT_NEAR((path.poses()[1].n_W - expected).norm(), 0.0, 1e-12);
  const Eigen::Quaterniond turn = first.T_V_C.R_V_C.conjugate() * second.T_V_C.R_V_C;
  EXPECT_NEAR((path.poses()[1].R_W_C.toRotationMatrix() - (R_W_C0 * turn).toRotationMatrix()).norm(), 0.0, 1e-12);
}

TEST(OdometryPath, GeometryOfAReadIsThePathsOwn) {
  std::mt19937 random(75);
  OdometryPath path(random_rotation(random));
  for (int i = 0; i < 5; ++i) path.add(pose_at(0.1 * i, random_vector(random, 3.0), random_rotation(random)));
  const CameraPose pose = pose_at(0.5, random_vector(random, 3.0), random_rotation(random));
  const Eigen::Vector3d velocity = random_vector(random, 1.0), turning = random_vector(random, 1.0);
  const ReadGeometry g = path.geometry(pose.T_V_C, velocity, turning);
  constexpr double kStep_s = 1e-3;
  const ReadGeometry later =
      path.geometry({pose.T_V_C.R_V_C, pose.T_V_C.p_V_C + kStep_s * velocity}, velocity, turning);
  path.add(pose);
  EXPECT_NEAR((g.n_W - path.poses().back().n_W).norm(), 0.0, 1e-12);
  EXPECT_NEAR((g.R_W_C - path.poses().back().R_W_C.toRotationMatrix()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(((later.n_W - g.n_W) / kStep_s - g.velocity_W).norm(), 0.0, 1e-10);
  EXPECT_EQ(g.angular_velocity_C, turning);  // stays in C
}

TEST(OdometryPath, CountsTravelButNotJitterAtStandstill) {
  std::mt19937 random(76);
  OdometryPath path(Eigen::Quaterniond::Identity());
  int frame = 0;
  for (int i = 0; i <= 100; ++i) path.add(pose_at(frame++ / 30.0, {0.01999 * i, 0.0, 0.0}));
  EXPECT_NEAR(path.arc_V(), 1.999, 0.011);  // travel is counted in steps of 0.01
  const double before = path.arc_V();
  for (int i = 0; i < 3000; ++i)
    path.add(pose_at(frame++ / 30.0, Eigen::Vector3d(1.999, 0.0, 0.0) + random_vector(random, 0.002)));
  EXPECT_EQ(path.arc_V(), before);
  for (int i = 0; i <= 500; ++i) path.add(pose_at(frame++ / 30.0, {1.999, 0.002 * i, 0.0}));  // slow, yet travel
  EXPECT_NEAR(path.arc_V() - before, 1.0, 0.011);
}

TEST(OdometryPath, ArcNeverFallsAndIsClampedToThePath) {
  std::mt19937 random(77);
  OdometryPath path(Eigen::Quaterniond::Identity());
  EXPECT_EQ(path.arc_at(at(1.0)), 0.0);
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int i = 0; i < 200; ++i) path.add(pose_at(1.0 + 0.1 * i, p += random_vector(random, 0.05)));
  double before = 0.0;
  for (double t = 0.0; t < 30.0; t += 0.013) {
    const double arc = path.arc_at(at(t));
    EXPECT_GE(arc, before);
    before = arc;
  }
  EXPECT_EQ(path.arc_at(at(0.5)), 0.0);
  EXPECT_EQ(path.arc_at(at(99.0)), path.arc_V());
  const auto& poses = path.poses();
  EXPECT_NEAR(path.arc_at(at(5.05)), 0.5 * (poses[40].arc_V + poses[41].arc_V), 1e-9);
}

TEST(OdometryPath, IgnoresPosesThatComeLate) {
  OdometryPath path(Eigen::Quaterniond::Identity());
  path.add(pose_at(1.0, {0, 0, 0}));
  path.add(pose_at(2.0, {1, 0, 0}));
  path.add(pose_at(2.0, {5, 0, 0}));
  path.add(pose_at(1.5, {5, 0, 0}));
  EXPECT_EQ(path.poses().size(), 2U);
  EXPECT_EQ(path.arc_V(), 1.0);
}

TEST(OdometryPath, EveryReadHasItsPlaceBetweenTwoKnots) {
  for (const double length_V : {0.0, 0.2, 0.99, 1.0, 3.7}) {
    OdometryPath path(Eigen::Quaterniond::Identity());
    for (int i = 0; i <= 37; ++i) path.add(pose_at(0.1 * i, {length_V * i / 37.0, 0.0, 0.0}));
    for (const double spacing_V : {0.25, 0.5, 1.0, 10.0}) {
      const auto intervals = path.intervals(spacing_V);
      ASSERT_GE(intervals.size(), 1U);
      const double end_V = path.arc_V();
      EXPECT_LE(end_V, spacing_V * static_cast<double>(intervals.size()));  // one knot at or beyond the end
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const KnotInterval& interval : intervals) {
        EXPECT_EQ(interval.length_V, spacing_V);
        EXPECT_LE(interval.step_W.norm(), spacing_V + 0.11);  // a frame's travel beyond
        sum += interval.step_W;
      }
      EXPECT_NEAR((sum - path.poses().back().n_W).norm(), 0.0, 1e-12);  // together they are the path
      for (double arc = 0.0; arc <= end_V; arc += 0.01) {
        const KnotPlace place = path.place(arc, spacing_V);
        EXPECT_GE(place.fraction, 0.0);
        EXPECT_LT(place.fraction, 1.0);
        EXPECT_GE(place.knot, 0);
        EXPECT_LT(static_cast<std::size_t>(place.knot), intervals.size());
        EXPECT_NEAR((place.knot + place.fraction) * spacing_V, arc, 1e-12);
      }
      EXPECT_LT(static_cast<std::size_t>(path.place(end_V, spacing_V).knot), intervals.size());
    }
  }
}

TEST(OdometryPath, HasTwoKnotsBeforeAnythingIsSeen) {
  const OdometryPath path(Eigen::Quaterniond::Identity());
  EXPECT_EQ(path.intervals(0.5).size(), 1U);
  EXPECT_EQ(path.place(0.0, 0.5).knot, 0);
}

// --- sampling synchronization ---

// Constant velocity, so that any interpolation must be exact.
CameraPose steady_pose(double seconds) {
  const Eigen::Vector3d turning(0.3, -0.2, 0.5);
  return pose_at(seconds, Eigen::Vector3d(0.4, 0.1, -0.2) * seconds, so3_exp(seconds * turning));
}

TEST(SamplingSynchronization, IsExactAtConstantVelocity) {
  SamplingSynchronization sync{Config{}};
  std::vector<SampledRead> all;
  const auto take = [&](const std::vector<SampledRead>& some) { all.insert(all.end(), some.begin(), some.end()); };
  for (int i = 0; i < 30; ++i) {
    take(sync.on(steady_pose(0.1 * i)));
    take(sync.on(read_at(0.1 * i + 0.017)));
    take(sync.on(read_at(0.1 * i + 0.083)));
  }
  ASSERT_EQ(all.size(), 58U);  // the last two still wait for a pose
  for (const SampledRead& s : all) {
    const UnscaledPose expected = steady_pose(static_cast<double>(s.read.time.ns) * 1e-9).T_V_C;
    EXPECT_NEAR((s.T_V_C.p_V_C - expected.p_V_C).norm(), 0.0, 1e-9);  // times to a nanosecond
    EXPECT_NEAR((s.T_V_C.R_V_C.toRotationMatrix() - expected.R_V_C.toRotationMatrix()).norm(), 0.0, 1e-8);
    EXPECT_NEAR((s.velocity_V - Eigen::Vector3d(0.4, 0.1, -0.2)).norm(), 0.0, 1e-7);
    EXPECT_NEAR((s.angular_velocity_C - Eigen::Vector3d(0.3, -0.2, 0.5)).norm(), 0.0, 1e-7);
  }
  EXPECT_EQ(sync.reads_without_pose(), 0U);
}

TEST(SamplingSynchronization, WaitsForThePoseAfterTheRead) {
  SamplingSynchronization sync{Config{}};
  EXPECT_TRUE(sync.on(steady_pose(0.0)).empty());
  EXPECT_TRUE(sync.on(read_at(0.05)).empty());
  EXPECT_EQ(sync.on(steady_pose(0.1)).size(), 1U);
  EXPECT_EQ(sync.on(read_at(0.07)).size(), 1U);  // late, but both poses are there
}

TEST(SamplingSynchronization, NeverExtrapolates) {
  SamplingSynchronization sync{Config{}};
  EXPECT_TRUE(sync.on(read_at(0.5)).empty());
  EXPECT_EQ(sync.reads_without_pose(), 0U);  // a pose may still come
  EXPECT_TRUE(sync.on(steady_pose(1.0)).empty());
  EXPECT_EQ(sync.reads_without_pose(), 1U);  // before the first pose
  EXPECT_EQ(sync.on(read_at(1.05)).size() + sync.on(read_at(1.09)).size(), 0U);
  EXPECT_EQ(sync.on(steady_pose(1.1)).size(), 2U);
  EXPECT_TRUE(sync.on(read_at(1.5)).empty());
  EXPECT_TRUE(sync.on(steady_pose(2.0)).empty());  // 0.9 s without a pose, 0.2 s are allowed
  EXPECT_EQ(sync.reads_without_pose(), 2U);
}

TEST(SamplingSynchronization, DoesNotBridgeSegments) {
  SamplingSynchronization sync{Config{}};
  (void)sync.on(steady_pose(1.0));
  (void)sync.on(read_at(1.05));
  CameraPose other = steady_pose(1.1);
  other.segment = 1;
  EXPECT_TRUE(sync.on(other).empty());
  EXPECT_EQ(sync.reads_without_pose(), 1U);
  (void)sync.on(read_at(1.15));
  other = steady_pose(1.2);
  other.segment = 1;
  const auto& ready = sync.on(other);
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_EQ(ready[0].segment, 1U);
}

TEST(SamplingSynchronization, TakesNoPoseThatIsLostOrStarting) {
  SamplingSynchronization sync{Config{}};
  (void)sync.on(steady_pose(1.0));
  for (const VoStatus status : {VoStatus::kLost, VoStatus::kInitialising}) {
    CameraPose pose = steady_pose(1.1);
    pose.status = status;
    (void)sync.on(read_at(1.05));
    EXPECT_TRUE(sync.on(pose).empty());
  }
  CameraPose degraded = steady_pose(1.15);
  degraded.status = VoStatus::kDegraded;
  EXPECT_EQ(sync.on(degraded).size(), 2U);
}

TEST(SamplingSynchronization, ReadsOutOfOrderComeOutInTimeOrder) {
  SamplingSynchronization sync{Config{}};
  (void)sync.on(steady_pose(1.0));
  for (const double t : {1.08, 1.02, 1.06, 1.04, 1.02})
    (void)sync.on(read_at(t, static_cast<std::uint8_t>(t * 100 - 100)));
  (void)sync.on(read_at(1.06, 99));  // of equal time: after the one that came first
  const auto& ready = sync.on(steady_pose(1.1));
  ASSERT_EQ(ready.size(), 6U);
  for (std::size_t i = 1; i < ready.size(); ++i) EXPECT_LE(ready[i - 1].read.time, ready[i].read.time);
  EXPECT_NE(ready[3].read.port, 99);
  EXPECT_EQ(ready[4].read.port, 99);
}

TEST(SamplingSynchronization, BoundsTheReadsThatWait) {
  SamplingSynchronization sync{Config{}};
  for (int i = 0; i < 5000; ++i) (void)sync.on(read_at(1.0 + 1e-4 * i));
  EXPECT_EQ(sync.reads_without_pose(), 5000U - 4096U);
}

}  // namespace
}  // namespace rfmvo
