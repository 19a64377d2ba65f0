#include "edges/camera_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <vector>

#include "edges/image_folder.hpp"
#include "edges/text_file.hpp"
#include "edges/toml_files.hpp"

namespace rfmvo {
namespace {

constexpr int kMaxSide_px = 20'000;

struct Raw {
  std::vector<double> matrix;  // fx, fy, cx, cy
  std::vector<double> distortion;
  std::string model;  // as written
  int width_px = 0, height_px = 0;
};

YAML::Node first_of(const YAML::Node& node, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (node[key]) return node[key];
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

// A list, or a matrix with its numbers under `data`.
std::vector<double> numbers_of(const YAML::Node& node) {
  if (!node.IsDefined() || node.IsNull()) return {};
  const YAML::Node& list = node.IsMap() && node["data"] ? node["data"] : node;
  return list.as<std::vector<double>>();
}

Raw read_kalibr(const YAML::Node& cam) {
  Raw raw;
  raw.matrix = numbers_of(cam["intrinsics"]);
  raw.distortion = numbers_of(cam["distortion_coeffs"]);
  raw.model = cam["distortion_model"] ? cam["distortion_model"].as<std::string>() : "none";
  if (cam["camera_model"] && cam["camera_model"].as<std::string>() != "pinhole")
    raw.model = cam["camera_model"].as<std::string>();
  const auto size = numbers_of(cam["resolution"]);
  if (size.size() == 2) raw.width_px = static_cast<int>(size[0]), raw.height_px = static_cast<int>(size[1]);
  return raw;
}

Raw read_opencv_or_ros(const YAML::Node& root) {
  Raw raw;
  const auto K = numbers_of(first_of(root, {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "k"}));
  if (K.size() == 9) raw.matrix = {K[0], K[4], K[2], K[5]};
  raw.distortion = numbers_of(
      first_of(root, {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs", "dist_coeffs", "D", "d"}));
  const YAML::Node model = root["distortion_model"], fisheye = root["fisheye_model"];
  raw.model = model ? model.as<std::string>() : fisheye && fisheye.as<int>() != 0 ? "fisheye" : "plumb_bob";
  const YAML::Node width = first_of(root, {"image_width", "image_Width", "width"});
  const YAML::Node height = first_of(root, {"image_height", "image_Height", "height"});
  if (width && height) raw.width_px = width.as<int>(), raw.height_px = height.as<int>();
  return raw;
}

bool all_finite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

Status set_distortion(const Raw& raw, CameraModel& camera) {
  const auto is = [&raw](std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(), [&raw](const char* name) { return raw.model == name; });
  };
  const auto unused = [&raw](std::size_t from) {
    return raw.distortion.size() <= from || std::all_of(raw.distortion.begin() + static_cast<std::ptrdiff_t>(from),
                                                        raw.distortion.end(), [](double k) { return k == 0.0; });
  };
  const std::size_t count = raw.distortion.size();
  if (is({"equidistant", "fisheye", "kannala_brandt"})) {
    if (count != 4) return Error{ErrorCode::kMalformed, "a fisheye lens has 4 distortion numbers", ""};
    camera.distortion = Distortion::kEquidistant;
    std::copy_n(raw.distortion.begin(), 4, camera.equidistant.begin());
    return Done{};
  }
  if (is({"radtan", "plumb_bob", "rational_polynomial"}) && unused(5)) {
    if (count != 0 && count < 4) return Error{ErrorCode::kMalformed, "4 or 5 distortion numbers are expected", ""};
    std::copy_n(raw.distortion.begin(), std::min<std::size_t>(count, 5), camera.radtan.begin());
    return Done{};
  }
  if (is({"none", ""}) && unused(0)) return Done{};
  return Error{ErrorCode::kUnsupported,
               "camera model \"" + raw.model + "\" is not supported; known: radtan, equidistant", ""};
}

Result<CameraModel> checked(const Raw& raw) {
  CameraModel camera;
  if (raw.matrix.size() != 4) return Error{ErrorCode::kMalformed, "holds no camera matrix or intrinsics", ""};
  if (raw.width_px < 1 || raw.height_px < 1 || raw.width_px > kMaxSide_px || raw.height_px > kMaxSide_px)
    return Error{ErrorCode::kMalformed, "holds no image size, or a wrong one", ""};
  if (!all_finite(raw.matrix) || !all_finite(raw.distortion) || !(raw.matrix[0] > 0.0) || !(raw.matrix[1] > 0.0))
    return Error{ErrorCode::kMalformed, "a number is not finite, or a focal length not positive", ""};
  camera.width_px = raw.width_px, camera.height_px = raw.height_px;
  camera.fx_px = raw.matrix[0], camera.fy_px = raw.matrix[1];
  camera.cx_px = raw.matrix[2], camera.cy_px = raw.matrix[3];
  if (const Status s = set_distortion(raw, camera); !s) return s.error();
  return camera;
}

// OpenCV's "%YAML:1.0" is no directive of YAML's; its matrices carry a tag, which is.
std::string standard_yaml(std::string_view yaml) {
  if (yaml.substr(0, 6) != "%YAML:") return std::string(yaml);
  const std::size_t end = yaml.find('\n');
  return end == std::string_view::npos ? "" : std::string(yaml.substr(end + 1));
}

}  // namespace

Result<CameraModel> parse_camera_yaml(std::string_view yaml, const std::string& where) {
  try {
    const YAML::Node root = YAML::Load(standard_yaml(yaml));
    if (!root.IsMap()) return Error{ErrorCode::kMalformed, "holds no camera calibration", where};
    const bool kalibr = root["cam0"].IsDefined() || root["intrinsics"].IsDefined();
    const auto camera =
        checked(kalibr ? read_kalibr(root["cam0"].IsDefined() ? root["cam0"] : root) : read_opencv_or_ros(root));
    if (!camera) return Error{camera.error().code, camera.error().what, where};
    return camera;
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    return Error{ErrorCode::kMalformed, error.msg, where + line};
  }
}

Result<CameraModel> read_camera_file(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".toml") {
    const auto calibration = read_calibration(path);
    if (!calibration) return calibration.error();
    return calibration.value().camera;
  }
  if (extension == ".txt") return read_camera_line(path);
  if (extension != ".yaml" && extension != ".yml")
    return Error{ErrorCode::kUnsupported, "a camera file is .yaml, .yml, .toml or .txt", path};
  const auto text = read_text_file(path);
  if (!text) return text.error();
  return parse_camera_yaml(text.value(), path);
}

}  // namespace rfmvo
