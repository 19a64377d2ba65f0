// A warehouse aisle, the demonstration: the cart drives past racks with cartons, some of which carry tags.
// Reads come from the physics of the surroundings (physical_link.cpp), not from statistics.
#include <algorithm>
#include <cmath>

#include "base/assert.hpp"
#include "base/units.hpp"
#include "simulate/aisle_surroundings.hpp"
#include "simulate/random.hpp"
#include "simulate/scene.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kSpeed_m_s = 0.5;
constexpr double kStandStill_s = 0.3;  // before the drive
constexpr double kSpeedUp_s = 1.0;
constexpr double kDuration_s = 13.0;  // about 6 m
constexpr double kCameraHeight_m = 1.05;
constexpr std::size_t kTags = 18;
constexpr double kTagEdge_m = 0.06;  // from a carton's edge

double travelled_m(double t_s) {
  const double t = std::max(0.0, t_s - kStandStill_s);
  const double ramped_s = t < kSpeedUp_s ? t * t / (2.0 * kSpeedUp_s) : t - 0.5 * kSpeedUp_s;
  // A person pushes: the speed swings by 15 % over 7 s.
  const double swing_rad_s = kTwoPi / 7.0;
  return kSpeed_m_s * (ramped_s + 0.15 / swing_rad_s * (1.0 - std::cos(swing_rad_s * ramped_s)));
}

// A gentle weave of +-0.15 m; the floor rocks the cart by 0.3 degrees and 2 mm.
Rigid3 body_pose(double t_s) {
  const double x_m = travelled_m(t_s);
  const double weave_rad_m = kTwoPi / 3.4;
  const double y_m = 0.15 * std::sin(weave_rad_m * x_m), slope = 0.15 * weave_rad_m * std::cos(weave_rad_m * x_m);
  Rigid3 pose = cart_pose({x_m, y_m, 0.002 * std::sin(kTwoPi * x_m / 0.9)}, 1.0, slope);
  const double roll_rad = rad_from_deg(0.3) * std::sin(kTwoPi * x_m / 1.3);
  const double pitch_rad = rad_from_deg(0.2) * std::sin(kTwoPi * x_m / 0.7);
  pose.R = (pose.R * so3_exp({roll_rad, pitch_rad, 0.0})).normalized();
  return pose;
}

Calibration calibration() {
  Calibration c;
  c.T_B_C = {looking_left(), {0.15, 0.2, kCameraHeight_m}};
  c.antennas.resize(2);
  c.antennas[0].port = 1;
  c.antennas[0].p_C_A_m = {-0.18, -0.40, 0.03};  // high, towards the rear
  c.antennas[1].port = 2;
  c.antennas[1].p_C_A_m = {0.18, 0.40, 0.03};  // low, towards the front
  return c;
}

// One tag on the front of a carton, on cartons spread along the drive.
void add_tags(Scene& scene, Environment& aisle, const std::vector<Carton>& cartons, std::uint64_t seed) {
  Random random(seed, "tag positions");
  Random look(seed, "label textures");
  std::vector<Carton> within;
  for (const Carton& c : cartons) {
    if (c.low.x() > 0.3 && c.high.x() < 6.2 && c.low.z() < 1.8) within.push_back(c);
  }
  // Every carton at most once: one drawn from each of kTags equal runs of the list.
  RFMVO_ASSERT(within.size() >= kTags);
  const double pitch = static_cast<double>(within.size()) / kTags;
  for (std::size_t n = 0; n < kTags; ++n) {
    const auto first = static_cast<std::size_t>(pitch * static_cast<double>(n));
    const auto last = static_cast<std::size_t>(pitch * static_cast<double>(n + 1));
    const Carton& c = within[first + random.below(last - first)];
    const double x_m = random.uniform(c.low.x() + kTagEdge_m, c.high.x() - kTagEdge_m);
    const double z_m = random.uniform(c.low.z() + kTagEdge_m, c.high.z() - kTagEdge_m);
    const Eigen::Vector3d p(x_m, c.low.y(), z_m);
    scene.tags.push_back({epc_of(n + 1), p});
    add_poster(aisle, p + Eigen::Vector3d(-0.035, -0.004, 0.022), 0.07, 0.044, label_texture(look));
  }
}

}  // namespace

Scene make_aisle_scene(const Options& options) {
  Scene scene;
  scene.name = "aisle";
  scene.physical_link = true;
  scene.frame_times_s = regular_frame_times(kDuration_s);
  scene.calibration = calibration();
  scene.T_S_C = [T_B_C = scene.calibration.T_B_C](double t_s) { return body_pose(t_s) * T_B_C; };
  auto aisle = std::make_shared<Environment>();
  const std::vector<Carton> cartons = build_aisle(*aisle, options.seed);
  add_tags(scene, *aisle, cartons, options.seed);
  scene.environment = aisle;
  attach_rendered_frames(scene, options.seed);
  return scene;
}

}  // namespace rfmvo::simulate
