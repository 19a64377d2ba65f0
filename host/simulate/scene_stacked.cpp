// S3 and S6, the scenes of the error bounds (DESIGN 2, FIELD 1): two antennas stacked 1.0 m, 20 tags
// beside a 4 m pass; `backandforth`, the drive of a calibration; and the degenerate relatives in which something is
// NOT observable.
#include <cmath>

#include "base/units.hpp"
#include "simulate/random.hpp"
#include "simulate/scene.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kLength_m = 4.0;
constexpr double kSpeed_m_s = 0.5;
constexpr double kWeave_m = 0.2;          // amplitude, one period over the pass
constexpr double kHalfStack_m = 0.5;      // antennas above and below the camera
constexpr double kTurnRate_rad_s = 0.15;  // purerotation
constexpr double kThereAndBack_s = 15.0, kDrive_s = 60.0, kBackAndForthWeave_m = 0.35;  // backandforth

struct Shape {
  double weave_m = kWeave_m;
  double duration_s = kLength_m / kSpeed_m_s;
  double structured_sigma_rad = 0.3;
  std::size_t tags = 20;
  std::size_t antennas = 2;
  bool forward_looking = false;  // beams along the path, tags on both sides: nothing tells left from right
  enum { kPass, kTurn, kStand, kBackAndForth } motion = kPass;
};

Shape shape_of(const std::string& name) {
  Shape s;
  if (name == "S6") s.structured_sigma_rad = 0.6;
  if (name == "straight" || name == "straight1ant" || name == "stackedmirror") s.weave_m = 0.0;
  if (name == "straight1ant" || name == "oneantenna") s.antennas = 1;
  if (name == "stackedmirror") s.forward_looking = true;
  if (name == "purerotation") s.motion = Shape::kTurn;
  if (name == "standstill") s.motion = Shape::kStand;
  if (name == "backandforth") {
    s.motion = Shape::kBackAndForth;
    s.duration_s = kDrive_s;
  }
  if (name == "onetag") s.tags = 1;
  if (name == "tags300") s.tags = 300;
  return s;
}

Rigid3 body_pose(const Shape& shape, double t_s) {
  const double mid_x_m = 0.5 * kLength_m;
  if (shape.motion == Shape::kStand) return cart_pose({mid_x_m, 0, 0}, 1, 0);
  if (shape.motion == Shape::kTurn) {
    // About the camera itself, to both sides of the shelf's normal: neither camera nor antennas travel.
    const double half_time_s = 0.5 * kLength_m / kSpeed_m_s;
    const double yaw_rad = kTurnRate_rad_s * (t_s - half_time_s);
    return cart_pose({mid_x_m, 0, 0}, std::cos(yaw_rad), std::sin(yaw_rad));
  }
  if (shape.motion == Shape::kBackAndForth) {
    // To and fro along the shelf, 1 m/s at most; the weave is out of step, so that no pass is like another. The cart
    // drives backwards as well as forwards: its nose stays near x.
    const double rate_rad_s = kTwoPi / kThereAndBack_s, weave_rad_s = 0.73 * rate_rad_s;
    const double yaw_rad = 0.35 * std::sin(1.31 * rate_rad_s * t_s);
    return cart_pose(
        {mid_x_m * (1.0 - std::cos(rate_rad_s * t_s)), kBackAndForthWeave_m * std::sin(weave_rad_s * t_s), 0},
        std::cos(yaw_rad), std::sin(yaw_rad));
  }
  const double x_m = kSpeed_m_s * t_s;
  const double wave_rad_m = kTwoPi / kLength_m;
  const double slope = shape.weave_m * wave_rad_m * std::cos(wave_rad_m * x_m);
  return cart_pose({x_m, shape.weave_m * std::sin(wave_rad_m * x_m), 0}, 1.0, slope);
}

Calibration calibration_of(const Shape& shape) {
  Calibration c;
  c.T_B_C.R = shape.forward_looking ? looking_forward() : looking_left();
  for (std::size_t a = 0; a < shape.antennas; ++a) {
    AntennaCalibration antenna;
    antenna.port = static_cast<std::uint8_t>(a + 1);
    antenna.p_C_A_m = {0.0, a == 0 ? -kHalfStack_m : kHalfStack_m, 0.0};  // image down = down: port 1 above
    c.antennas.push_back(antenna);
  }
  return c;
}

}  // namespace

bool is_stacked_scene(const std::string& name) {
  for (const std::string& known : scene_names()) {
    if (name == known) return name != "aisle" && name != "wall" && !is_drive_scene(name);
  }
  return false;
}

Scene make_stacked_scene(const Options& options) {
  Shape shape = shape_of(options.scene);
  if (options.tags != 0) shape.tags = options.tags;
  Scene scene;
  scene.name = options.scene;
  scene.structured_sigma_rad = shape.structured_sigma_rad;
  scene.frame_times_s = regular_frame_times(shape.duration_s);
  scene.calibration = calibration_of(shape);
  // tags300: a fast reader mode, two reads of each tag a second.
  if (options.scene == "tags300") scene.read_rate_hz = 2.0 * static_cast<double>(shape.tags);
  if (options.read_rate_hz) scene.read_rate_hz = *options.read_rate_hz;
  const Rigid3 T_B_C = scene.calibration.T_B_C;
  scene.T_S_C = [shape, T_B_C](double t_s) { return body_pose(shape, t_s) * T_B_C; };

  Random random(options.seed, "tag positions");
  const double pitch_m = kLength_m / static_cast<double>(shape.tags);
  for (std::size_t n = 0; n < shape.tags; ++n) {
    double x_m = (static_cast<double>(n) + random.uniform()) * pitch_m;
    double y_m = random.uniform(1.2, 2.5);
    const double z_m = random.uniform(-0.8, 0.8);
    if (shape.tags == 1) x_m = 0.5 * kLength_m + random.uniform(-0.3, 0.3);
    if (shape.forward_looking) {
      x_m += 1.0;  // the beams look ahead
      if (n % 2 == 1) y_m = -y_m;
    }
    scene.tags.push_back({epc_of(n + 1), {x_m, y_m, z_m}});
  }
  return scene;
}

}  // namespace rfmvo::simulate
