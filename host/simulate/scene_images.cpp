// A real image sequence, with virtual antennas on the real camera and virtual tags in front of it.
#include "simulate/image_folder.hpp"
#include "simulate/radio_link.hpp"
#include "simulate/random.hpp"
#include "simulate/scene.hpp"

namespace rfmvo::simulate {
namespace {

constexpr std::size_t kTags = 8;                                // unless told otherwise
constexpr double kNear_m = 1.2, kFar_m = 2.2, kAcross_m = 0.8;  // tags in front of the path
constexpr double kBeamCosine = 0.574;                           // 55 degrees: well inside the beam
constexpr double kReadableShare = 0.4;                          // of the time, by both antennas
constexpr int kAttempts = 300;
constexpr double kProbe_s = 0.1;

// The truth of a recorded sequence is another sensor's (a depth camera, a motion-capture rig), and not quite the
// motion that the images show. On 7-Scenes RedKitchen, image-only poses (COLMAP over all its sequences: Brachmann et
// al., ICCV 2021) fit the KinectFusion truth best with the camera 2 to 12 cm per axis away from where that has it.
constexpr double kFrameOffset_m = 0.05;
// And their axes: path and orientations of that truth disagree with the images by 4.9 degrees (docs/accuracy.md).
constexpr double kFrameRotation_rad = 0.07;

Calibration calibration_of(const CameraModel& camera) {
  Calibration c;
  c.camera = camera;
  c.antennas.resize(2);
  c.antennas[0].port = 1;
  c.antennas[0].p_C_A_m = {-0.20, 0.25, 0.0};  // 20 cm left, 25 cm below
  c.antennas[1].port = 2;
  c.antennas[1].p_C_A_m = {0.20, -0.25, 0.0};  // 20 cm right, 25 cm above
  return c;
}

// Share of the time in which the last tag is well inside the beam of the antenna that sees it less.
double readable_share(const Scene& scene) {
  double worst = 1.0;
  for (std::size_t a = 0; a < scene.calibration.antennas.size(); ++a) {
    int seen = 0, all = 0;
    for (double t_s = scene.start_s(); t_s <= scene.end_s(); t_s += kProbe_s, ++all) {
      const Sight sight = sight_of(scene, t_s, a, scene.tags.size() - 1);
      if (sight.cosine > kBeamCosine && sight.distance_m > 0.5 && sight.distance_m < 3.5) ++seen;
    }
    worst = std::min(worst, static_cast<double>(seen) / all);
  }
  return worst;
}

// Seen from a pose drawn along the path; of several draws the first that is readable long enough.
void place_tags(Scene& scene, std::size_t count, Random& random) {
  for (std::size_t n = 0; n < count; ++n) {
    scene.tags.push_back({epc_of(n + 1), Eigen::Vector3d::Zero()});
    double best_share = -1.0;
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    for (int attempt = 0; attempt < kAttempts && best_share < kReadableShare; ++attempt) {
      const double t_s = random.uniform(scene.start_s(), scene.end_s());
      const double x_m = random.uniform(-kAcross_m, kAcross_m);
      const double y_m = random.uniform(-kAcross_m, kAcross_m);
      const double z_m = random.uniform(kNear_m, kFar_m);
      scene.tags.back().p_S_X_m = scene.T_S_C(t_s) * Eigen::Vector3d(x_m, y_m, z_m);
      const double share = readable_share(scene);
      if (share > best_share) {
        best_share = share;
        best = scene.tags.back().p_S_X_m;
      }
    }
    scene.tags.back().p_S_X_m = best;
  }
}

}  // namespace

Result<Scene> make_image_scene(const Options& options) {
  Result<ImageFolder> read = read_image_folder(options.images_dir);
  if (!read.ok()) return read.error();
  auto folder = std::make_shared<const ImageFolder>(std::move(read).value());
  Scene scene;
  scene.name = "images";
  scene.calibration = calibration_of(folder->camera);
  scene.frame_offset_sigma_m = kFrameOffset_m;
  scene.frame_rotation_sigma_rad = kFrameRotation_rad;
  for (const ImageEntry& entry : folder->images) scene.frame_times_s.push_back(entry.t_s);
  scene.T_S_C = [folder](double t_s) { return pose_at(folder->truth, t_s); };
  scene.frame = [folder](std::size_t k) -> Result<Frame> {
    const ImageEntry& entry = folder->images[k];
    auto bytes = read_bytes(entry.path);
    if (!bytes.ok()) return bytes.error();
    Frame frame;
    frame.width_px = folder->camera.width_px;
    frame.height_px = folder->camera.height_px;
    frame.encoding = entry.encoding;
    frame.encoded = bytes.value();
    return frame;
  };
  Random random(options.seed, "tag positions");
  place_tags(scene, options.tags != 0 ? options.tags : kTags, random);
  return scene;
}

}  // namespace rfmvo::simulate
