#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <map>

#include "base/units.hpp"
#include "simulate/environment.hpp"
#include "simulate/inventory.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kFrequency_hz = 923e6;

Scene aisle(std::uint64_t seed) {
  Options options;
  options.scene = "aisle";
  options.seed = seed;
  return make_scene(options).value();
}

double line_of_sight_rad(const Scene& scene, const Singulation& s) {
  return 4.0 * kPi * kFrequency_hz * sight_of(scene, s.t_s, s.antenna, s.tag).distance_m / kSpeedOfLight_m_s;
}

// Root mean square of phase minus line of sight; the mean of each (tag, antenna) is an offset, not an error.
double multipath_rms_rad(const Scene& scene, std::uint64_t seed) {
  const RadioLink link = make_physical_link(scene);
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> errors;
  for (const Singulation& s : gen2_inventory(scene, link, seed)) {
    const double phase_rad = link(s.t_s, s.antenna, s.tag, kFrequency_hz).phase_rad;
    errors[{s.tag, s.antenna}].push_back(phase_rad - line_of_sight_rad(scene, s));
  }
  double squares = 0.0;
  int count = 0;
  for (const auto& [pair, list] : errors) {
    std::complex<double> mean;
    for (const double e : list) mean += std::polar(1.0, e);
    for (const double e : list) squares += std::pow(std::remainder(e - std::arg(mean), kTwoPi), 2);
    count += static_cast<int>(list.size());
  }
  return std::sqrt(squares / count);
}

TEST(PhysicalLink, MultipathOfTheAisleIsAsStrongAsMeasuredInRealRooms) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const double rms_rad = multipath_rms_rad(aisle(seed), seed);
    RecordProperty("multipath_rms_rad_seed_" + std::to_string(seed), std::to_string(rms_rad));
    EXPECT_GT(rms_rad, 0.2);
    EXPECT_LT(rms_rad, 0.6);
  }
}

TEST(PhysicalLink, WithoutReflectionsThePhaseIsTheLineOfSight) {
  Scene scene = aisle(1);
  scene.environment = std::make_shared<const Environment>();
  const RadioLink link = make_physical_link(scene);
  for (const Singulation& s : gen2_inventory(scene, link, 1)) {
    const double phase_rad = link(s.t_s, s.antenna, s.tag, kFrequency_hz).phase_rad;
    EXPECT_NEAR(std::remainder(phase_rad - line_of_sight_rad(scene, s), kTwoPi), 0.0, 1e-9);
  }
}

// A floor below two points at equal height h, d apart: the image path is sqrt(d^2 + 4 h^2) long.
TEST(PhysicalLink, FloorReflectionIsTheMirrorImage) {
  Scene scene = aisle(1);
  scene.tags.resize(1);
  const Sight sight = sight_of(scene, 0.0, 0, 0);
  scene.tags[0].p_S_X_m = sight.p_S_A_m + Eigen::Vector3d(0.0, 2.0, 0.0);
  Environment floor;
  floor.reflectors.push_back(
      {{0, 0, sight.p_S_A_m.z() - 0.7}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), 50, 50, -1e-6});
  const auto power_and_phase = [&](const Environment& e) {
    scene.environment = std::make_shared<const Environment>(e);
    const LinkState state = make_physical_link(scene)(0.0, 0, 0, kFrequency_hz);
    return std::polar(std::pow(10.0, state.rssi_dbm / 40.0), -0.5 * state.phase_rad);  // h, up to a factor
  };
  const std::complex<double> ratio = power_and_phase(floor) / power_and_phase({});
  const double image_m = std::sqrt(4.0 + 4.0 * 0.49);
  const double wave_number = kTwoPi * kFrequency_hz / kSpeedOfLight_m_s;
  const double expected_arg = kPi - wave_number * (image_m - 2.0);  // the coefficient is negative
  EXPECT_NEAR(std::remainder(std::arg(ratio - 1.0) - expected_arg, kTwoPi), 0.0, 1e-3);
}

TEST(PhysicalLink, EveryTagOfTheAisleIsReadByBothAntennas) {
  const Scene scene = aisle(1);
  std::map<std::pair<std::size_t, std::size_t>, int> reads;
  for (const Singulation& s : gen2_inventory(scene, make_physical_link(scene), 1)) ++reads[{s.tag, s.antenna}];
  EXPECT_GE(reads.size(), 2 * scene.tags.size() - 2);
}

TEST(PatchGain, IsHalfAtThirtyFiveDegreesAndFlatBehind) {
  EXPECT_NEAR(patch_gain_db(1.0), 0.0, 1e-12);
  EXPECT_NEAR(patch_gain_db(std::cos(rad_from_deg(35.0))), -3.01, 0.02);
  EXPECT_EQ(patch_gain_db(-0.5), -20.0);
}

}  // namespace
}  // namespace rfmvo::simulate
