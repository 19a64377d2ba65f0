#include "simulate/image_folder.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

namespace rfmvo::simulate {
namespace {

// Calls `take` with every line that is neither empty nor a comment; `take` says what is wrong, or "".
Status each_line(const std::string& path, const std::function<std::string(std::istringstream&)>& take) {
  std::ifstream file(path);
  if (!file) return Error{ErrorCode::kNotFound, "cannot be opened", path};
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    std::istringstream words(line);
    const std::string wrong = take(words);
    if (!wrong.empty()) return Error{ErrorCode::kMalformed, wrong, path + ":" + std::to_string(number)};
  }
  return Done{};
}

std::string encoding_of(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension == ".jpg" || extension == ".jpeg") return "jpeg";
  return extension == ".png" ? "png" : "";
}

Status read_times(const std::string& directory, std::vector<ImageEntry>& images) {
  return each_line(directory + "/times.txt", [&](std::istringstream& words) -> std::string {
    ImageEntry entry;
    std::string name;
    if (!(words >> entry.t_s >> name) || !std::isfinite(entry.t_s)) return "expected: time (s) and file name";
    if (!images.empty() && entry.t_s <= images.back().t_s) return "time does not increase";
    entry.encoding = encoding_of(name);
    if (entry.encoding.empty()) return "'" + name + "' is neither .jpg, .jpeg nor .png";
    entry.path = directory + "/" + name;
    if (!std::filesystem::is_regular_file(entry.path)) return "image '" + entry.path + "' does not exist";
    images.push_back(entry);
    return "";
  });
}

Status read_poses(const std::string& directory, std::vector<StampedPose>& truth) {
  return each_line(directory + "/groundtruth.txt", [&](std::istringstream& words) -> std::string {
    StampedPose pose;
    Eigen::Vector3d& t = pose.T_G_C.t;
    double qx = 0, qy = 0, qz = 0, qw = 0;
    if (!(words >> pose.t_s >> t.x() >> t.y() >> t.z() >> qx >> qy >> qz >> qw))
      return "expected: t tx ty tz qx qy qz qw";
    const Eigen::Quaterniond q(qw, qx, qy, qz);
    if (!std::isfinite(pose.t_s) || !t.allFinite() || !(std::abs(q.norm() - 1.0) < 0.01)) {
      return "not a rigid pose: the quaternion's norm must be 1";
    }
    if (!truth.empty() && pose.t_s <= truth.back().t_s) return "time does not increase";
    pose.T_G_C.R = q.normalized();
    truth.push_back(pose);
    return "";
  });
}

Status read_camera(const std::string& directory, CameraModel& camera) {
  bool found = false;
  const Status status = each_line(directory + "/calib.txt", [&](std::istringstream& words) -> std::string {
    std::string model;
    if (!(words >> camera.fx_px >> camera.fy_px >> camera.cx_px >> camera.cy_px >> camera.width_px >>
          camera.height_px >> model)) {
      return "expected: fx fy cx cy width height model d0..";
    }
    if (camera.fx_px <= 0 || camera.fy_px <= 0 || camera.width_px <= 0 || camera.height_px <= 0)
      return "must be positive";
    if (model != "none" && model != "radtan" && model != "equidistant")
      return "unknown distortion model '" + model + "' (none | radtan | equidistant)";
    if (model == "equidistant") camera.distortion = Distortion::kEquidistant;
    for (std::size_t i = 0; model == "equidistant" && i < camera.equidistant.size() && words >> camera.equidistant[i];
         ++i) {
    }
    for (std::size_t i = 0; model == "radtan" && i < camera.radtan.size() && words >> camera.radtan[i]; ++i) {
    }
    found = true;
    return "";
  });
  if (!status.ok()) return status;
  if (!found) return Error{ErrorCode::kMalformed, "holds no calibration", directory + "/calib.txt"};
  return Done{};
}

}  // namespace

Result<ImageFolder> read_image_folder(const std::string& directory) {
  ImageFolder folder;
  if (Status s = read_camera(directory, folder.camera); !s.ok()) return s.error();
  if (Status s = read_poses(directory, folder.truth); !s.ok()) return s.error();
  if (Status s = read_times(directory, folder.images); !s.ok()) return s.error();
  if (folder.truth.size() < 2)
    return Error{ErrorCode::kMalformed, "fewer than two poses", directory + "/groundtruth.txt"};
  // Frames without truth cannot carry simulated reads.
  const double first_s = folder.truth.front().t_s, last_s = folder.truth.back().t_s;
  std::erase_if(folder.images, [&](const ImageEntry& e) { return e.t_s < first_s || e.t_s > last_s; });
  if (folder.images.size() < 2) {
    return Error{ErrorCode::kMalformed, "fewer than two images in the time span of groundtruth.txt",
                 directory + "/times.txt"};
  }
  return folder;
}

Result<std::shared_ptr<const std::vector<std::uint8_t>>> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorCode::kUnreadable, "image cannot be opened", path};
  auto bytes = std::make_shared<std::vector<std::uint8_t>>(std::istreambuf_iterator<char>(file),
                                                           std::istreambuf_iterator<char>());
  if (file.bad() || bytes->empty()) return Error{ErrorCode::kUnreadable, "image cannot be read", path};
  return std::shared_ptr<const std::vector<std::uint8_t>>(std::move(bytes));
}

Rigid3 pose_at(const std::vector<StampedPose>& truth, double t_s) {
  const auto after =
      std::upper_bound(truth.begin(), truth.end(), t_s, [](double t, const StampedPose& pose) { return t < pose.t_s; });
  if (after == truth.begin()) return truth.front().T_G_C;
  if (after == truth.end()) return truth.back().T_G_C;
  const StampedPose& a = *(after - 1);
  return interpolate(a.T_G_C, after->T_G_C, (t_s - a.t_s) / (after->t_s - a.t_s));
}

}  // namespace rfmvo::simulate
