// Drives that try the odometry: past a shelf at several speeds, with a turn, a stop, a slanted view, a rolling
// shutter; among people, in the dark, down a corridor. Tags stick on the cartons; the radio link is statistical.
#include <algorithm>
#include <cmath>

#include "base/assert.hpp"
#include "base/units.hpp"
#include "simulate/scene.hpp"
#include "simulate/warehouse.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kCameraHeight_m = 1.05;
constexpr double kSpeedUp_s = 1.0;
constexpr std::size_t kTags = 12;
constexpr double kStraight_m = 10.0;  // of the aisle; longer drives go back and forth
constexpr double kTurnRadius_m = 1.3;
constexpr double kTurnAt_m = kCrossAisleBegin_m + 0.4;  // x where the turn into the cross-aisle begins

struct Drive {
  const char* name;
  double speed_m_s;
  double duration_s;
  double camera_yaw_deg = 0.0;  // from looking left towards looking forward
  bool turns = false, stops = false, crowd = false, corridor = false;
  double from_x_m = 0.0, y_m = 0.0;
  double readout_s = 0.0, exposure_s = 0.004;
  double noise_grey = 1.5, gain = 1.0;
};

constexpr Drive kDrives[] = {
    {.name = "shelf05", .speed_m_s = 0.5, .duration_s = 14.0},
    {.name = "shelf1", .speed_m_s = 1.0, .duration_s = 10.0},
    {.name = "shelf1rs", .speed_m_s = 1.0, .duration_s = 10.0, .readout_s = 0.025},
    {.name = "shelfturn", .speed_m_s = 0.8, .duration_s = 12.0, .turns = true, .from_x_m = kTurnAt_m - 5.0},
    {.name = "shelfstop", .speed_m_s = 1.0, .duration_s = 13.0, .stops = true},
    {.name = "shelfdiag", .speed_m_s = 1.0, .duration_s = 10.0, .camera_yaw_deg = 40.0},
    {.name = "crowd", .speed_m_s = 0.5, .duration_s = 14.0, .crowd = true, .y_m = -1.3},
    {.name = "dark", .speed_m_s = 0.5, .duration_s = 14.0, .exposure_s = 0.015, .noise_grey = 4.0, .gain = 0.35},
    {.name = "corridor", .speed_m_s = 1.0, .duration_s = 14.0, .camera_yaw_deg = 90.0, .corridor = true},
};

const Drive* find_drive(const std::string& name) {
  for (const Drive& d : kDrives) {
    if (name == d.name) return &d;
  }
  return nullptr;
}

// Distance since a start from rest; a person pushes, so the speed swings by 10 % over 7 s.
double rolled_m(double speed_m_s, double t_s) {
  const double t = std::max(0.0, t_s);
  const double ramped_s = t < kSpeedUp_s ? t * t / (2.0 * kSpeedUp_s) : t - 0.5 * kSpeedUp_s;
  const double swing_rad_s = kTwoPi / 7.0;
  return speed_m_s * (ramped_s + 0.1 / swing_rad_s * (1.0 - std::cos(swing_rad_s * ramped_s)));
}

// Time that the drive's clock shows: it stops for 3 s, slowing down and speeding up within a second each.
double running_s(double t_s) {
  constexpr double kStop_s = 4.5, kStand_s = 3.0, kSlow_s = 1.0;
  if (t_s < kStop_s) return t_s;
  const double u = t_s - kStop_s;
  if (u < kSlow_s) return kStop_s + u - u * u / (2.0 * kSlow_s);
  const double stopped = kStop_s + 0.5 * kSlow_s;
  const double v = u - kSlow_s - kStand_s;
  if (v < 0.0) return stopped;
  return v < kSlow_s ? stopped + v * v / (2.0 * kSlow_s) : stopped + v - 0.5 * kSlow_s;
}

// Back and forth, turning around softly: 0..kStraight_m and back.
double folded_m(double s_m) {
  constexpr double kSoft_m = 0.5;
  const double period_m = 2.0 * kStraight_m;
  const double into = s_m - period_m * std::floor(s_m / period_m);
  const double there = into < kStraight_m ? into : period_m - into;
  const double edge = std::min(there, kStraight_m - there);
  const double soft = edge < kSoft_m ? (kSoft_m - edge) * (kSoft_m - edge) / (2.0 * kSoft_m) : 0.0;
  return s_m < kStraight_m - kSoft_m ? there : (there > 0.5 * kStraight_m ? there - soft : there + soft);
}

// Along the aisle, a quarter turn to the left, on down the cross-aisle.
Rigid3 turning_pose(const Drive& d, double s_m) {
  const double straight_m = kTurnAt_m - d.from_x_m, arc_m = 0.5 * kPi * kTurnRadius_m;
  if (s_m < straight_m) return cart_pose({d.from_x_m + s_m, d.y_m, 0.0}, 1.0, 0.0);
  const double angle = std::min((s_m - straight_m) / kTurnRadius_m, 0.5 * kPi);
  const double on_m = std::max(0.0, s_m - straight_m - arc_m);
  const Eigen::Vector3d p(kTurnAt_m + kTurnRadius_m * std::sin(angle),
                          d.y_m + kTurnRadius_m * (1.0 - std::cos(angle)) + on_m, 0.0);
  return cart_pose(p, std::cos(angle), std::sin(angle));
}

// The floor rocks the cart by 0.3 degrees and 2 mm, and nobody steers quite straight.
Rigid3 body_pose(const Drive& d, double t_s) {
  const double s_m = rolled_m(d.speed_m_s, d.stops ? running_s(t_s) : t_s);
  if (d.turns) {
    Rigid3 pose = turning_pose(d, s_m);
    pose.t.z() += 0.002 * std::sin(kTwoPi * s_m / 0.9);
    return {(pose.R * so3_exp({rad_from_deg(0.3) * std::sin(kTwoPi * s_m / 1.3), 0.0, 0.0})).normalized(), pose.t};
  }
  const double x_m = d.corridor ? std::min(s_m, kCorridorEnd_m - 6.0) : folded_m(s_m);
  const double weave_rad_m = kTwoPi / 3.4, weave_m = 0.06;
  const double y_m = d.y_m + weave_m * std::sin(weave_rad_m * x_m);
  Rigid3 pose = cart_pose({d.from_x_m + x_m, y_m, 0.002 * std::sin(kTwoPi * x_m / 0.9)}, 1.0,
                          weave_m * weave_rad_m * std::cos(weave_rad_m * x_m));
  const double roll_rad = rad_from_deg(0.3) * std::sin(kTwoPi * x_m / 1.3);
  const double pitch_rad = rad_from_deg(0.2) * std::sin(kTwoPi * x_m / 0.7);
  pose.R = (pose.R * so3_exp({roll_rad, pitch_rad, 0.0})).normalized();
  return pose;
}

Calibration calibration_of(const Drive& d) {
  Calibration c;
  const Eigen::Quaterniond to_front(Eigen::AngleAxisd(-rad_from_deg(d.camera_yaw_deg), Eigen::Vector3d::UnitZ()));
  c.T_B_C = {(to_front * looking_left()).normalized(), {0.15, 0.2, kCameraHeight_m}};
  c.antennas.resize(2);
  c.antennas[0].port = 1;
  c.antennas[0].p_C_A_m = {-0.18, -0.40, 0.03};
  c.antennas[1].port = 2;
  c.antennas[1].p_C_A_m = {0.18, 0.40, 0.03};
  return c;
}

void add_crowd(Environment& e, const Drive& d, std::uint64_t seed) {
  Random look(seed, "crowd textures");
  // 2.0 to 2.5 m from the camera: together they cover up to 40 % of the picture.
  e.movers.push_back(make_person({{6.0, d.y_m + 2.3, 0.0}, 0.0, -0.8}, look));
  e.movers.push_back(make_person({{0.7, d.y_m + 2.4, 0.0}, 1.5, 0.52}, look));  // walks along, slightly faster
  e.movers.push_back(make_forklift({{-3.5, d.y_m + 2.45, 0.0}, 2.0, 1.3}, look));
  e.movers.push_back(make_person({{9.0, d.y_m + 2.2, 0.0}, 6.0, -1.1}, look));
  e.movers.push_back(make_forklift({{13.0, d.y_m + 2.5, 0.0}, 7.0, -1.5}, look));
}

CameraEffects effects_of(const Drive& d) {
  CameraEffects effects;
  effects.exposure_s = d.exposure_s;
  effects.readout_s = d.readout_s;
  effects.noise_grey = d.noise_grey;
  effects.vignetting = 0.25;
  // The exposure control breathes a little.
  effects.gain = [gain = d.gain](double t_s) { return gain * (1.0 + 0.06 * std::sin(kTwoPi * t_s / 5.0)); };
  return effects;
}

void add_tags(Scene& scene, Environment& e, const Drive& d, std::vector<Eigen::Vector3d> places, std::uint64_t seed) {
  Random look(seed, "label textures");
  std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
  const double from_m = d.from_x_m + 0.3, to_m = d.from_x_m + std::min(kStraight_m, d.speed_m_s * d.duration_s);
  std::erase_if(places, [&](const auto& p) { return p.x() < from_m || p.x() > to_m; });
  const std::size_t count = std::min(kTags, places.size());
  for (std::size_t n = 0; n < count; ++n) {
    const Eigen::Vector3d p = places[n * places.size() / count];
    scene.tags.push_back({epc_of(n + 1), p});
    add_poster(e, p + Eigen::Vector3d(-0.035, -0.004, 0.022), 0.07, 0.044, label_texture(look));
  }
}

}  // namespace

bool is_drive_scene(const std::string& name) { return find_drive(name) != nullptr; }

Scene make_drive_scene(const Options& options) {
  const Drive* drive = find_drive(options.scene);
  RFMVO_ASSERT(drive != nullptr);
  Scene scene;
  scene.name = options.scene;
  scene.frame_times_s = regular_frame_times(options.duration_s.value_or(drive->duration_s));
  scene.calibration = calibration_of(*drive);
  scene.T_S_C = [d = *drive, T_B_C = scene.calibration.T_B_C](double t_s) { return body_pose(d, t_s) * T_B_C; };
  scene.camera_effects = effects_of(*drive);
  auto place = std::make_shared<Environment>();
  const auto places = drive->corridor ? build_corridor(*place, options.seed) : build_warehouse(*place, options.seed);
  if (drive->crowd) add_crowd(*place, *drive, options.seed);
  add_tags(scene, *place, *drive, places, options.seed);
  scene.environment = place;
  attach_rendered_frames(scene, options.seed);
  return scene;
}

}  // namespace rfmvo::simulate
