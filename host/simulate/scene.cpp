#include "simulate/scene.hpp"

#include <cmath>

namespace rfmvo::simulate {

constexpr double kFrameRate_hz = 30.0;  // the paper's camera, Section VII-A

std::vector<std::string> scene_names() {
  return {"aisle",        "wall",       "S3",     "S6",      "straight", "straight1ant", "oneantenna", "stackedmirror",
          "purerotation", "standstill", "onetag", "tags300", "shelf05",  "shelf1",       "shelf1rs",   "shelfturn",
          "shelfstop",    "shelfdiag",  "crowd",  "dark",    "corridor", "backandforth"};
}

bool is_degenerate_scene(const std::string& name) {
  return is_stacked_scene(name) && name != "S3" && name != "S6" && name != "tags300" && name != "backandforth";
}

namespace {

Result<Scene> make_family(const Options& options) {
  if (!options.images_dir.empty()) return make_image_scene(options);
  if (options.scene == "aisle") return make_aisle_scene(options);
  if (options.scene == "wall") return make_wall_scene(options);
  if (is_drive_scene(options.scene)) return make_drive_scene(options);
  if (is_stacked_scene(options.scene)) return make_stacked_scene(options);
  std::string known;
  for (const std::string& name : scene_names()) known += (known.empty() ? "" : ", ") + name;
  return Error{ErrorCode::kUnknownKey, "unknown scene '" + options.scene + "'; known: " + known, "--scene"};
}

}  // namespace

Result<Scene> make_scene(const Options& options) {
  Result<Scene> made = make_family(options);
  if (!made.ok()) return made;
  Scene scene = std::move(made).value();
  if (options.tags != 0 && scene.tags.size() != options.tags)
    return Error{ErrorCode::kUnsupported, "the tags of scene '" + scene.name + "' are part of its surroundings",
                 "--tags"};
  if (options.structured_rad && scene.physical_link)
    return Error{ErrorCode::kUnsupported, "phase errors in scene '" + scene.name + "' come from its surroundings",
                 "--structured-rad"};
  scene.structured_sigma_rad = options.structured_rad.value_or(scene.structured_sigma_rad);
  return scene;
}

Epc epc_of(std::size_t n) {
  // Header 0x30 (SGTIN-96); the rest is fixed but for the serial number at the end.
  std::array<std::uint8_t, 12> bytes{0x30, 0x34, 0x25, 0x7B, 0xF4, 0x6D, 0xB6, 0x40, 0, 0, 0, 0};
  bytes[10] = static_cast<std::uint8_t>((n >> 8) & 0xFF);
  bytes[11] = static_cast<std::uint8_t>(n & 0xFF);
  return Epc::from_bytes(bytes).value();
}

std::vector<double> regular_frame_times(double duration_s) {
  std::vector<double> times;
  const int count = static_cast<int>(std::floor(duration_s * kFrameRate_hz + 1e-9));
  for (int k = 0; k <= count; ++k) times.push_back(k / kFrameRate_hz);
  return times;
}

Rigid3 cart_pose(const Eigen::Vector3d& p_S_B_m, double dx, double dy) {
  const double yaw_rad = std::atan2(dy, dx);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), p_S_B_m};
}

Eigen::Quaterniond looking_left() {
  Eigen::Matrix3d R_B_C;
  R_B_C << 1, 0, 0,  //
      0, 0, 1,       //
      0, -1, 0;
  return Eigen::Quaterniond(R_B_C);
}

Eigen::Quaterniond looking_forward() { return Calibration{}.T_B_C.R; }

}  // namespace rfmvo::simulate
