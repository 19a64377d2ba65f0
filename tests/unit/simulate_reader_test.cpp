#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/units.hpp"
#include "simulate/reader.hpp"

namespace rfmvo::simulate {
namespace {

Scene scene_of(const std::string& name, std::uint64_t seed = 1) {
  Options options;
  options.scene = name;
  options.seed = seed;
  return make_scene(options).value();
}

double rate_hz(const Scene& scene, std::size_t reads) {
  return static_cast<double>(reads) / (scene.end_s() - scene.start_s());
}

TEST(SimulateReader, PhaseWithoutNoiseIsDistancePlusOffsetsToHalfACount) {
  Scene scene = scene_of("S3");
  scene.structured_sigma_rad = 0.0;
  const RadioLink link = make_statistical_link(scene, 1);
  const auto singulations = statistical_inventory(scene, link, 1);
  const ReaderHardware hardware = draw_hardware(scene.tags.size(), 2, 1);
  const auto reads = report(scene, singulations, link, hardware, 1, DeviceTime{}, {.white = false, .flips = false});
  ASSERT_GT(reads.size(), 500U);
  for (std::size_t i = 0; i < reads.size(); ++i) {
    const Singulation& s = singulations[i];
    const Eigen::Vector3d p_S_A = scene.T_S_C(s.t_s) * scene.calibration.antennas[s.antenna].p_C_A_m;
    const double d_m = (scene.tags[s.tag].p_S_X_m - p_S_A).norm() + hardware.port_length_m[s.antenna];
    const double expected_rad = 4.0 * kPi * reads[i].frequency_hz * d_m / kSpeedOfLight_m_s +
                                hardware.tag_offset_rad[s.tag] + hardware.port_offset_rad[s.antenna];
    const double half_step_rad = 0.5 * kTwoPi / 2048.0;  // 12 bits, even counts
    EXPECT_LE(std::abs(std::remainder(reads[i].phase.turn_q16 * kTwoPi / 65536.0 - expected_rad, kTwoPi)),
              half_step_rad + 1e-9);
  }
}

TEST(SimulateReader, ReportsOnlyEvenCountsOfTwelveBits) {
  const Scene scene = scene_of("S3");
  const RadioLink link = make_statistical_link(scene, 1);
  for (const TagRead& read :
       report(scene, statistical_inventory(scene, link, 1), link, draw_hardware(20, 2, 1), 1, DeviceTime{})) {
    EXPECT_EQ(read.phase.turn_q16 % 32, 0);
    EXPECT_EQ(read.seen_count, 1);
    EXPECT_EQ(read.time.ns % 1000, 0);
    EXPECT_GE(read.frequency_hz, 920'625'000U);
    EXPECT_LE(read.frequency_hz, 925'375'000U);
  }
}

TEST(SimulateReader, PiFlipsAreRareAndBursty) {
  const Scene scene = scene_of("onetag");
  const RadioLink link = make_statistical_link(scene, 1);
  const std::vector<Singulation> one{statistical_inventory(scene, link, 1).front()};
  const std::vector<Singulation> many(400'000, one.front());
  const ReaderHardware hardware = draw_hardware(1, 2, 1);
  const auto reads = report(scene, many, link, hardware, 9, DeviceTime{}, {.white = false, .flips = true});
  const auto clean = report(scene, one, link, hardware, 9, DeviceTime{}, {.white = false, .flips = false});
  int flips = 0, bursts = 0;
  bool before = false;
  for (const TagRead& read : reads) {
    const bool flipped = read.phase.turn_q16 != clean[0].phase.turn_q16;
    flips += flipped ? 1 : 0;
    bursts += flipped && !before ? 1 : 0;
    before = flipped;
  }
  // 0.3 % of 400 000 in bursts of mean 5: about 240 bursts, so 7 to 10 % of statistical error.
  EXPECT_NEAR(flips / 400'000.0, 0.003, 0.001);
  EXPECT_NEAR(static_cast<double>(flips) / bursts, 5.0, 1.5);
}

TEST(SimulateReader, WhiteNoiseGrowsAsTheSignalWeakens) {
  const Scene scene = scene_of("S3");
  const RadioLink link = make_statistical_link(scene, 1);
  for (const Singulation& s : statistical_inventory(scene, link, 1)) {
    const LinkState state = link(s.t_s, s.antenna, s.tag, 923e6);
    const double expected = state.rssi_dbm > -45 ? 0.022 : state.rssi_dbm > -55 ? 0.06 : 0.2;
    EXPECT_EQ(state.white_sigma_rad, expected);
  }
}

TEST(SimulateReader, FailsToReadTagsBehindTheAntenna) {
  Scene scene = scene_of("straight1ant");
  for (SceneTag& tag : scene.tags) tag.p_S_X_m.y() *= -1.0;
  EXPECT_TRUE(statistical_inventory(scene, make_statistical_link(scene, 1), 1).empty());
}

TEST(SimulateInventory, RatesAreThoseOfARealReader) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Scene many = scene_of("S3", seed), one = scene_of("onetag", seed);
    EXPECT_NEAR(rate_hz(many, statistical_inventory(many, make_statistical_link(many, seed), seed).size()), 79.0, 5.0);
    EXPECT_LE(rate_hz(one, statistical_inventory(one, make_statistical_link(one, seed), seed).size()), 75.0);
  }
}

// A link of unlimited reach leaves the protocol's own timing.
TEST(SimulateInventory, Gen2RoundsReachTheRatesOfARealReader) {
  const RadioLink perfect = [](double, std::size_t, std::size_t, double) {
    LinkState link;
    link.readable = true;
    return link;
  };
  const Scene many = scene_of("S3"), one = scene_of("onetag");
  EXPECT_NEAR(rate_hz(many, gen2_inventory(many, perfect, 1).size()), 79.0, 8.0);
  EXPECT_NEAR(rate_hz(one, gen2_inventory(one, perfect, 1).size()), 70.0, 7.0);
}

TEST(SimulateInventory, GapsAreHeavyTailed) {
  const Scene scene = scene_of("S3");
  std::map<std::pair<std::size_t, std::size_t>, double> last_s;
  std::vector<double> gaps_s;
  for (const Singulation& s : statistical_inventory(scene, make_statistical_link(scene, 1), 1)) {
    const auto pair = std::pair{s.tag, s.antenna};
    if (last_s.contains(pair)) gaps_s.push_back(s.t_s - last_s[pair]);
    last_s[pair] = s.t_s;
  }
  std::sort(gaps_s.begin(), gaps_s.end());
  const double median_s = gaps_s[gaps_s.size() / 2], p90_s = gaps_s[gaps_s.size() * 9 / 10];
  EXPECT_GT(median_s, 0.08);
  EXPECT_LT(median_s, 0.4);
  EXPECT_GT(p90_s, 4.0 * median_s);  // exponential gaps would give 3.3
  EXPECT_LT(p90_s, 2.0);
}

}  // namespace
}  // namespace rfmvo::simulate
