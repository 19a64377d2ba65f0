// The paper's experiment (Section VII, Fig. 6): a cart passes a flat wall with four checkerboards, two of
// which carry four RFID tags each at their corners; two 8 dBi antennas about half a metre apart.
#include <cmath>

#include "base/units.hpp"
#include "simulate/environment.hpp"
#include "simulate/random.hpp"
#include "simulate/scene.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kWallY_m = 1.6;
constexpr double kLength_m = 4.5;
constexpr double kDuration_s = 15.0;
constexpr double kCameraHeight_m = 1.05;
constexpr double kSquare_m = 0.029;  // of the checkerboards, Section VII-A
constexpr int kSquares = 16;
constexpr int kNotices = 60;
constexpr double kBoard_m = kSquare_m * kSquares;

// Mean 0.3 m/s, between 0.12 and 0.48 m/s: "different speeds and trajectories" within the 1 m/s limit.
double travelled_m(double t_s) {
  const double mean_m_s = kLength_m / kDuration_s, swing_rad_s = kTwoPi * 2.0 / kDuration_s;
  return mean_m_s * (t_s - 0.6 / swing_rad_s * std::sin(swing_rad_s * t_s));
}

// Distance to the wall 1.25 .. 1.95 m.
Rigid3 body_pose(double t_s) {
  const double x_m = travelled_m(t_s);
  const double slow_rad_m = kTwoPi / 4.0, fast_rad_m = kTwoPi / 1.7;
  const double y_m = 0.28 * std::sin(slow_rad_m * x_m) + 0.02 * std::sin(fast_rad_m * x_m);
  const double slope = 0.28 * slow_rad_m * std::cos(slow_rad_m * x_m) + 0.02 * fast_rad_m * std::cos(fast_rad_m * x_m);
  return cart_pose({x_m, y_m, 0.0}, 1.0, slope);
}

Calibration calibration() {
  Calibration c;
  c.T_B_C = {looking_left(), {0.1, 0.15, kCameraHeight_m}};
  c.antennas.resize(2);
  c.antennas[0].port = 1;
  c.antennas[0].p_C_A_m = {-0.25, -0.12, 0.02};  // behind the camera along the path, and higher
  c.antennas[1].port = 2;
  c.antennas[1].p_C_A_m = {0.25, 0.10, 0.02};
  return c;
}

struct Board {
  double x_m, z_m;  // upper left corner
};
constexpr Board kBoards[] = {{0.3, 1.55}, {1.35, 1.40}, {2.5, 1.50}, {3.6, 1.35}};

// Four corners of the second and the third board; the first `count` of them (0: all).
void add_tags(Scene& scene, Environment& room, Random& random, std::size_t count) {
  for (const Board& board : {kBoards[1], kBoards[2]}) {
    for (const double dx_m : {0.05, kBoard_m - 0.05}) {
      for (const double dz_m : {0.05, kBoard_m - 0.05}) {
        if (count != 0 && scene.tags.size() == count) return;
        const double jitter_m = random.uniform(-0.02, 0.02);
        const Eigen::Vector3d p(board.x_m + dx_m + jitter_m, kWallY_m, board.z_m - dz_m);
        scene.tags.push_back({epc_of(scene.tags.size() + 1), p});
        add_poster(room, p + Eigen::Vector3d(-0.022, -0.004, 0.022), 0.044, 0.044, label_texture(random));
      }
    }
  }
}

void furnish(Environment& room, Random& random) {
  const TexturePointer plaster = plaster_texture(random), floor = concrete_texture(random);
  Surface wall{
      {-3.0, kWallY_m, 2.8}, Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ(), 11.0, 2.8, plaster, {330, 330}, 1.0F};
  room.surfaces.push_back(wall);
  Surface ground{
      {-3.0, kWallY_m, 0.0}, Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY(), 11.0, 4.0, floor, {400, 400}, 0.9F};
  room.surfaces.push_back(ground);
  const TexturePointer checks = checkerboard_texture(kSquares);
  for (const Board& board : kBoards) {
    add_poster(room, {board.x_m, kWallY_m - 0.003, board.z_m}, kBoard_m, kBoard_m, checks);
  }
  // Notices all over the wall, as an office has them; the boards hang in front of some.
  for (int n = 0; n < kNotices; ++n) {
    const double x_m = -2.0 + 8.5 * (n + random.uniform()) / kNotices, z_m = random.uniform(0.5, 2.3);
    const double width_m = random.uniform(0.15, 0.4);
    const double y_m = kWallY_m - 0.001 - 2e-5 * n;  // where two overlap, always the same one is in front
    add_poster(room, {x_m, y_m, z_m}, width_m, 1.3 * width_m, cardboard_texture(random));
  }
  for (int n = 0; n < 9; ++n) {  // boxes at the foot of the wall: depth for the odometry
    const double x_m = -1.4 + 0.85 * n, depth_m = random.uniform(0.2, 0.45), height_m = random.uniform(0.25, 0.6);
    const BoxTextures textures{cardboard_texture(random), cardboard_texture(random), cardboard_texture(random)};
    add_box(room, {x_m, kWallY_m - depth_m, 0.0}, {x_m + random.uniform(0.3, 0.6), kWallY_m, height_m}, textures);
  }
}

}  // namespace

Scene make_wall_scene(const Options& options) {
  Scene scene;
  scene.name = "wall";
  scene.structured_sigma_rad = 0.3;
  scene.capture_sigma = 0.4;  // few tags in plain view: they share the slots almost evenly
  scene.frame_times_s = regular_frame_times(kDuration_s);
  scene.calibration = calibration();
  scene.T_S_C = [T_B_C = scene.calibration.T_B_C](double t_s) { return body_pose(t_s) * T_B_C; };
  auto room = std::make_shared<Environment>();
  Random look(options.seed, "textures");
  furnish(*room, look);
  Random random(options.seed, "tag positions");
  add_tags(scene, *room, random, options.tags);
  scene.environment = room;
  attach_rendered_frames(scene, options.seed);
  return scene;
}

}  // namespace rfmvo::simulate
