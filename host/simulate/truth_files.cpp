// The truth of a run as files beside the journal, never inside it.
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "edges/toml_files.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::simulate {
namespace {

constexpr const char* kTagsHeader = "epc,x_m,y_m,z_m";
constexpr const char* kScaleHeader = "m_per_unit";
constexpr const char* kTrajectoryHeader = "# t[s] tx ty tz qx qy qz qw (T_W_C: metres, camera optical frame)";

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

Status write_file(const std::string& path, const std::string& content) {
  const std::string temporary = path + ".tmp";
  std::error_code failure;
  {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file << content;
    file.flush();
    if (!file) {
      std::filesystem::remove(temporary, failure);
      return Error{ErrorCode::kUnwritable, "cannot be written", path};
    }
  }
  std::filesystem::rename(temporary, path, failure);
  if (failure) return Error{ErrorCode::kUnwritable, failure.message(), path};
  return Done{};
}

// Seconds with all nine digits: a double holds only 0.2 us of a time since 1970.
std::string seconds_of(DeviceTime time) {
  char text[40];
  std::snprintf(text, sizeof text, "%lld.%09lld", static_cast<long long>(time.ns / 1'000'000'000),
                static_cast<long long>(time.ns % 1'000'000'000));
  return text;
}

bool parse_seconds(const std::string& text, DeviceTime& time) {
  const std::size_t dot = text.find('.');
  std::string fraction = dot == std::string::npos ? "" : text.substr(dot + 1);
  if (fraction.size() > 9) return false;
  fraction.resize(9, '0');
  std::int64_t whole = 0, part = 0;
  const std::size_t end = dot == std::string::npos ? text.size() : dot;
  const auto a = std::from_chars(text.data(), text.data() + end, whole);
  const auto b = std::from_chars(fraction.data(), fraction.data() + fraction.size(), part);
  if (a.ec != std::errc{} || a.ptr != text.data() + end || b.ec != std::errc{} || b.ptr != fraction.data() + 9)
    return false;
  if (whole < 0 || whole > 9'000'000'000) return false;
  time.ns = whole * 1'000'000'000 + part;
  return true;
}

std::string tags_text(const Truth& truth) {
  std::string text = std::string(kTagsHeader) + "\n";
  for (const TrueTag& tag : truth.tags) {
    text += tag.epc.hex() + "," + number(tag.p_W_X_m.x()) + "," + number(tag.p_W_X_m.y()) + "," +
            number(tag.p_W_X_m.z()) + "\n";
  }
  return text;
}

std::string trajectory_text(const Truth& truth) {
  std::string text = std::string(kTrajectoryHeader) + "\n";
  for (const TruePose& pose : truth.trajectory) {
    const Eigen::Vector3d& t = pose.T_W_C.t;
    const Eigen::Quaterniond& q = pose.T_W_C.R;
    text += seconds_of(pose.time);
    for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) text += " " + number(value);
    text += "\n";
  }
  return text;
}

// Calls `take` with every line after the header (or comments); false: the line is wrong.
Status each_line(const std::string& path, const std::string& header,
                 const std::function<bool(const std::string&)>& take) {
  std::ifstream file(path);
  if (!file) return Error{ErrorCode::kNotFound, "cannot be opened", path};
  std::string line;
  for (int n = 1; std::getline(file, line); ++n) {
    if (line.empty() || line == header || line[0] == '#') continue;
    if (!take(line))
      return Error{ErrorCode::kMalformed, "'" + line + "' is not understood", path + ":" + std::to_string(n)};
  }
  return Done{};
}

bool take_tag(std::string line, Truth& truth) {
  for (char& c : line) c = c == ',' ? ' ' : c;
  std::istringstream words(line);
  std::string hex;
  TrueTag tag;
  Eigen::Vector3d& p = tag.p_W_X_m;
  if (!(words >> hex >> p.x() >> p.y() >> p.z()) || !p.allFinite()) return false;
  const Result<Epc> epc = Epc::from_hex(hex);
  if (!epc.ok()) return false;
  tag.epc = epc.value();
  truth.tags.push_back(tag);
  return true;
}

bool take_pose(const std::string& line, Truth& truth) {
  std::istringstream words(line);
  std::string time;
  TruePose pose;
  Eigen::Vector3d& t = pose.T_W_C.t;
  Eigen::Vector4d q;  // x y z w, as Eigen keeps its coefficients
  if (!(words >> time >> t.x() >> t.y() >> t.z() >> q[0] >> q[1] >> q[2] >> q[3])) return false;
  if (!parse_seconds(time, pose.time) || !t.allFinite() || !(std::abs(q.norm() - 1.0) < 0.01)) return false;
  pose.T_W_C.R.coeffs() = q.normalized();
  truth.trajectory.push_back(pose);
  return true;
}

std::string camera_text(const CameraModel& c) {
  std::string text = "# fx fy cx cy width height model d0..\n";
  for (const double value : {c.fx_px, c.fy_px, c.cx_px, c.cy_px}) text += number(value) + " ";
  text += std::to_string(c.width_px) + " " + std::to_string(c.height_px) + " radtan";
  for (const double k : c.radtan) text += " " + number(k);
  return text + "\n";
}

}  // namespace

Status write_image_folder(const Options& options, const std::string& directory) {
  std::error_code failure;
  std::filesystem::create_directories(directory + "/images", failure);
  if (failure) return Error{ErrorCode::kUnwritable, failure.message(), directory};
  std::string times = "# t[s] file\n";
  CameraModel camera;
  const auto write_frame = [&](const Event& event) -> Status {
    if (const auto* start = std::get_if<Start>(&event)) camera = start->calibration.camera;
    const auto* frame = std::get_if<Frame>(&event);
    if (!frame) return Done{};
    char name[40];
    std::snprintf(name, sizeof name, "images/%06lld.%s", static_cast<long long>(frame->sequence),
                  frame->encoding == "png" ? "png" : "jpg");
    times += seconds_of(frame->time) + " " + name + "\n";
    return write_file(directory + "/" + name, {frame->encoded->begin(), frame->encoded->end()});
  };
  const Result<Truth> truth = simulate(options, write_frame);
  if (!truth.ok()) return truth.error();
  if (times.find("images/") == std::string::npos)
    return Error{ErrorCode::kUnsupported, "scene '" + options.scene + "' has no pictures", "--frames"};
  if (Status s = write_file(directory + "/calib.txt", camera_text(camera)); !s.ok()) return s;
  if (Status s = write_file(directory + "/groundtruth.txt", trajectory_text(truth.value())); !s.ok()) return s;
  return write_file(directory + "/times.txt", times);
}

Status write_truth(const Truth& truth, const std::string& directory) {
  std::error_code failure;
  std::filesystem::create_directories(directory, failure);
  if (failure) return Error{ErrorCode::kUnwritable, failure.message(), directory};
  if (Status s = write_file(directory + "/tags.csv", tags_text(truth)); !s.ok()) return s;
  if (Status s = write_file(directory + "/trajectory.tum", trajectory_text(truth)); !s.ok()) return s;
  if (Status s = write_file(directory + "/antennas.toml", to_toml(truth.calibration)); !s.ok()) return s;
  return write_file(directory + "/scale.csv", std::string(kScaleHeader) + "\n" + number(truth.scale_m_per_unit) + "\n");
}

Result<Truth> read_truth(const std::string& directory) {
  Truth truth;
  if (Status s =
          each_line(directory + "/tags.csv", kTagsHeader, [&](const std::string& l) { return take_tag(l, truth); });
      !s.ok()) {
    return s.error();
  }
  if (Status s =
          each_line(directory + "/trajectory.tum", "", [&](const std::string& l) { return take_pose(l, truth); });
      !s.ok()) {
    return s.error();
  }
  Result<Calibration> calibration = read_calibration(directory + "/antennas.toml");
  if (!calibration.ok()) return calibration.error();
  truth.calibration = calibration.value();
  const Status scale = each_line(directory + "/scale.csv", kScaleHeader, [&](const std::string& line) {
    std::istringstream words(line);
    return static_cast<bool>(words >> truth.scale_m_per_unit) && truth.scale_m_per_unit > 0.0;
  });
  if (!scale.ok()) return scale.error();
  return truth;
}

}  // namespace rfmvo::simulate
