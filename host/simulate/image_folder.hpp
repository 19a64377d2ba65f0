// A recorded image sequence with metric truth: images/, times.txt, groundtruth.txt, calib.txt.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "geometry/camera_model.hpp"
#include "geometry/rigid.hpp"

namespace rfmvo::simulate {

struct ImageEntry {
  double t_s = 0.0;
  std::string path;
  std::string encoding;  // "jpeg" | "png"
};

struct StampedPose {
  double t_s = 0.0;
  Rigid3 T_G_C;  // G: the world of the recording, metric
};

struct ImageFolder {
  CameraModel camera;
  std::vector<ImageEntry> images;  // increasing times, all inside the truth's time span
  std::vector<StampedPose> truth;  // increasing times
};

// Every line is checked and every image must exist; errors name file and line.
[[nodiscard]] Result<ImageFolder> read_image_folder(const std::string& directory);

[[nodiscard]] Result<std::shared_ptr<const std::vector<std::uint8_t>>> read_bytes(const std::string& path);

// Camera pose at t, between the two nearest of the truth; held at its ends.
[[nodiscard]] Rigid3 pose_at(const std::vector<StampedPose>& truth, double t_s);

}  // namespace rfmvo::simulate
