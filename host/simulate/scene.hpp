// What is simulated: a cart's motion, what is bolted on it, where the tags are, what surrounds them.
// Everything is in S, the scene's own metric frame (x along the shelf, y towards it, z up); simulate()
// re-expresses the truth in W.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "config/calibration.hpp"
#include "simulate/renderer.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::simulate {

struct SceneTag {
  Epc epc;
  Eigen::Vector3d p_S_X_m;
};

struct Scene {
  std::string name;
  std::vector<double> frame_times_s;    // since the run's epoch, increasing
  std::function<Rigid3(double)> T_S_C;  // camera pose at a time (s), continuous
  Calibration calibration;              // the true one
  // Per axis: how far the camera of the images may be from that of the truth, and turned against it.
  double frame_offset_sigma_m = 0.0, frame_rotation_sigma_rad = 0.0;
  std::vector<SceneTag> tags;
  double structured_sigma_rad = 0.3;  // of the statistical radio link
  double read_rate_hz = 79.0;         // of the statistical inventory with many tags; measured with 29, DESIGN 2.8
  double capture_sigma = 1.0;         // spread of ln(chance to win a slot) between tags: makes gaps heavy-tailed
  std::shared_ptr<const Environment> environment;   // null: statistical link, no rendered frames
  CameraEffects camera_effects;                     // of rendered frames
  bool physical_link = false;                       // phase and power from the environment's reflections
  std::function<Result<Frame>(std::size_t)> frame;  // k-th frame without its time; empty: the scene has no frames

  [[nodiscard]] double start_s() const { return frame_times_s.front(); }
  [[nodiscard]] double end_s() const { return frame_times_s.back(); }
};

// Errors: unknown scene (the text lists the known ones); anything wrong with an image folder.
[[nodiscard]] Result<Scene> make_scene(const Options& options);

// Makers, one per family.
[[nodiscard]] bool is_stacked_scene(const std::string& name);
[[nodiscard]] Scene make_stacked_scene(const Options& options);
[[nodiscard]] Scene make_wall_scene(const Options& options);
[[nodiscard]] Scene make_aisle_scene(const Options& options);
[[nodiscard]] bool is_drive_scene(const std::string& name);
[[nodiscard]] Scene make_drive_scene(const Options& options);
[[nodiscard]] Result<Scene> make_image_scene(const Options& options);

// Lets the scene's frames be rendered from its environment. Call it when everything else is set.
void attach_rendered_frames(Scene& scene, std::uint64_t seed);

// EPC of the n-th simulated tag: a 96-bit SGTIN-like code that ends in n.
[[nodiscard]] Epc epc_of(std::size_t n);

// 30 frames a second from 0 to the end.
[[nodiscard]] std::vector<double> regular_frame_times(double duration_s);

// Body pose on a floor path: x forward along (dx, dy).
[[nodiscard]] Rigid3 cart_pose(const Eigen::Vector3d& p_S_B_m, double dx, double dy);

// Camera that looks to the cart's left: image right = forward, image down = down.
[[nodiscard]] Eigen::Quaterniond looking_left();
// Camera that looks forward, as Calibration's default.
[[nodiscard]] Eigen::Quaterniond looking_forward();

}  // namespace rfmvo::simulate
