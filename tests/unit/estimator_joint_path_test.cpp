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

CameraPose pose_at(double seconds, const Eigen::Vector3d& p_V_C, const Eigen::Quaterniond& R = Eigen::Quaterniond::Identity()) {
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
std::vector<TimedPhase> hopping_chain(double length_m, double noise_rad, std::mt19937& random, bool hops = true) {
  std::vector<TimedPhase> chain;
  std::normal_distribution<double> normal(0.0, noise_rad);
  std::uniform_int_distribution<int> channel(0, 15);
  const double start_m = 1.0 + 0.1 * channel(random), offset_rad = 0.4 * channel(random);
  double frequency_hz = 920e6;
  for (int i = 0; i < 200; ++i) {
    if (hops && i % 4 == 0) frequency_hz = 920e6 + 0.25e6 * channel(random);
    const double time_s = 0.05 * i;
    const double distance_m = start_m + 0.3 * std::sin(0.7 * time_s);  // up to 0.2 m/s, towards and away
    const double term = joint_scene::frequency_term_rad_m(frequency_hz);
    const double phase = joint_scene::wavenumber_rad_m(920e6) * distance_m + term * (distance_m + length_m) + offset_rad + normal(random);
    chain.push_back({time_s, std::remainder(phase, 2.0 * joint_scene::kPi), term});
  }
  return chain;
}

TEST(ElectricalLength, IsRecoveredFromHopsInMotionAndNoise) {
  std::mt19937 random(71);
  std::vector<std::vector<TimedPhase>> chains;
  double mean_m = 0.0;
  for (int t = 0; t < 6; ++t) chains.push_back(hopping_chain(8.0, 0.3, random));
  const ElectricalLength found = electrical_length_from_hops(chains);
  // The mean tag distance (1.0 .. 2.5 m) belongs to it: the truth is 8 m and that, taken from the noise-free chain.
  std::mt19937 same(71);
  for (int t = 0; t < 6; ++t) {
    const std::vector<TimedPhase> chain = hopping_chain(8.0, 0.3, same);
    (void)chain;
  }
  std::mt19937 again(71);
  std::vector<std::vector<TimedPhase>> silent;
  for (int t = 0; t < 6; ++t) silent.push_back(hopping_chain(0.0, 0.3, again));
  mean_m = electrical_length_from_hops(silent).length_m;
  EXPECT_GT(mean_m, 0.5);
  EXPECT_LT(mean_m, 3.0);
  EXPECT_NEAR(found.length_m - mean_m, 8.0, 0.11);  // a step of the search
  EXPECT_GT(found.coherence, 0.5);
}

TEST(ElectricalLength, IsNotClaimedWithoutHops) {
  std::mt19937 random(72);
  EXPECT_EQ(electrical_length_from_hops({}).coherence, 0.0);
  EXPECT_EQ(electrical_length_from_hops({{}, {{0.0, 1.0, 0.1}}}).coherence, 0.0);
  EXPECT_EQ(electrical_length_from_hops({hopping_chain(8.0, 0.3, random, false)}).coherence, 0.0);
}

}  // namespace
}  // namespace rfmvo
