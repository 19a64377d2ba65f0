// `rfmvo vo DIR`: the odometry alone on a folder of images; path as TUM file, figures against truth.
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "commands/commands.hpp"
#include "vision/visual_odometry.hpp"

namespace rfmvo {
namespace {

namespace fs = std::filesystem;

struct TimedImage {
  DeviceTime time;
  std::string path;
};

struct TruthPose {
  double time_s;
  Eigen::Vector3d p_W_C;
};

struct VoRun {
  std::vector<CameraPose> poses;
  std::vector<double> cpu_ms;  // of the odometry, per frame, without reading the image
  double total_cpu_s = 0.0;    // with reading
};

// Fields of each line that is not a comment.
std::vector<std::vector<std::string>> read_table(const fs::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path.string() + ": cannot be read");
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    rows.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  return rows;
}

CameraModel read_camera(const fs::path& path) {
  constexpr std::size_t kFields = 7;  // fx fy cx cy width height model
  const auto rows = read_table(path);
  if (rows.empty() || rows[0].size() < kFields) throw std::runtime_error(path.string() + ": fx fy cx cy width height model expected");
  const auto& f = rows[0];
  CameraModel camera;
  camera.fx_px = std::stod(f[0]), camera.fy_px = std::stod(f[1]);
  camera.cx_px = std::stod(f[2]), camera.cy_px = std::stod(f[3]);
  camera.width_px = std::stoi(f[4]), camera.height_px = std::stoi(f[5]);
  if (f[6] != "none" && f[6] != "radtan") throw std::runtime_error(path.string() + ": unknown model " + f[6]);
  for (std::size_t i = kFields; i < f.size() && i - kFields < camera.radtan.size(); ++i) camera.radtan[i - kFields] = std::stod(f[i]);
  return camera;
}

std::vector<TimedImage> read_images(const fs::path& dir) {
  std::vector<TimedImage> images;
  for (const auto& row : read_table(dir / "times.txt")) {
    if (row.size() < 2) throw std::runtime_error((dir / "times.txt").string() + ": `t filename` expected");
    images.push_back({DeviceTime{Duration::from_seconds(std::stod(row[0])).ns}, (dir / row[1]).string()});
  }
  return images;
}

std::vector<TruthPose> read_truth(const fs::path& path) {
  std::vector<TruthPose> truth;
  if (!fs::exists(path)) return truth;
  for (const auto& row : read_table(path)) {
    if (row.size() >= 4) truth.push_back({std::stod(row[0]), {std::stod(row[1]), std::stod(row[2]), std::stod(row[3])}});
  }
  return truth;
}

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Frame to_frame(const TimedImage& image, std::int64_t sequence) {
  const cv::Mat grey = cv::imread(image.path, cv::IMREAD_GRAYSCALE);
  if (grey.empty()) throw std::runtime_error(image.path + ": not an image");
  Frame frame;
  frame.time = image.time;
  frame.sequence = sequence;
  frame.width_px = grey.cols;
  frame.height_px = grey.rows;
  frame.grey = std::make_shared<const std::vector<std::uint8_t>>(grey.data, grey.data + grey.total());
  return frame;
}

VoRun run(const fs::path& dir) {
  VisualOdometry odometry(VisionConfig{}, read_camera(dir / "calib.txt"));
  VoRun result;
  const double begin = cpu_seconds();
  for (const TimedImage& image : read_images(dir)) {
    const Frame frame = to_frame(image, static_cast<std::int64_t>(result.poses.size()));
    const double before = cpu_seconds();
    result.poses.push_back(odometry.on(frame));
    result.cpu_ms.push_back(1e3 * (cpu_seconds() - before));
  }
  result.total_cpu_s = cpu_seconds() - begin;
  return result;
}

bool has_pose(const CameraPose& p) { return p.status == VoStatus::kTracking || p.status == VoStatus::kDegraded; }

struct PathError {
  std::size_t poses = 0;
  double rms_m = 0.0;
  double path_m = 0.0;
  double scale_m = 0.0;  // metres per unit of V
};

// Of the longest segment, after the best similarity transform (Umeyama 1991).
std::optional<PathError> path_error(const std::vector<CameraPose>& poses, const std::vector<TruthPose>& truth) {
  std::map<std::uint32_t, int> count;
  for (const CameraPose& p : poses) count[p.segment] += has_pose(p);
  if (count.empty() || truth.empty()) return std::nullopt;
  const auto longest = std::max_element(count.begin(), count.end(), [](auto& a, auto& b) { return a.second < b.second; });
  std::vector<Eigen::Vector3d> estimate, reference;
  for (const CameraPose& p : poses) {
    if (!has_pose(p) || p.segment != longest->first) continue;
    const double t = Duration{p.time.ns}.seconds();
    const auto near = std::min_element(truth.begin(), truth.end(), [t](const auto& a, const auto& b) {
      return std::abs(a.time_s - t) < std::abs(b.time_s - t);
    });
    constexpr double kSameTime_s = 0.005;
    if (std::abs(near->time_s - t) > kSameTime_s) continue;
    estimate.push_back(p.T_V_C.p_V_C);
    reference.push_back(near->p_W_C);
  }
  constexpr std::size_t kLeast = 3;
  if (estimate.size() < kLeast) return std::nullopt;
  Eigen::Matrix3Xd a(3, estimate.size()), b(3, estimate.size());
  PathError error;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    a.col(static_cast<Eigen::Index>(i)) = estimate[i];
    b.col(static_cast<Eigen::Index>(i)) = reference[i];
    if (i > 0) error.path_m += (reference[i] - reference[i - 1]).norm();
  }
  const Eigen::Matrix4d T = Eigen::umeyama(a, b, true);
  error.poses = estimate.size();
  error.scale_m = T.topLeftCorner<3, 1>().norm();
  const Eigen::Matrix3Xd d = ((T.topLeftCorner<3, 3>() * a).colwise() + T.topRightCorner<3, 1>()) - b;
  error.rms_m = std::sqrt(d.squaredNorm() / static_cast<double>(estimate.size()));
  return error;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

nlohmann::ordered_json summary(const VoRun& r, const std::optional<PathError>& error) {
  std::set<std::uint32_t> segments;
  std::size_t tracked = 0, degraded = 0, first = r.poses.size();
  for (std::size_t i = 0; i < r.poses.size(); ++i) {
    if (!has_pose(r.poses[i])) continue;
    first = std::min(first, i);
    ++tracked;
    degraded += r.poses[i].status == VoStatus::kDegraded;
    segments.insert(r.poses[i].segment);
  }
  double sum = 0.0;
  for (const double ms : r.cpu_ms) sum += ms;
  const auto n = static_cast<double>(r.poses.size());
  nlohmann::ordered_json j;
  j["frames"] = r.poses.size();
  j["tracked"] = tracked;
  j["degraded"] = degraded;
  j["first_pose_frame"] = first;
  j["first_pose_s"] = first < r.poses.size() ? (r.poses[first].time - r.poses[0].time).seconds() : -1.0;
  j["tracked_share_after_start"] = first < r.poses.size() ? static_cast<double>(tracked) / (n - static_cast<double>(first)) : 0.0;
  j["segments"] = segments.size();
  j["cpu_ms_mean"] = n > 0 ? sum / n : 0.0;
  j["cpu_ms_p50"] = quantile(r.cpu_ms, 0.5);
  j["cpu_ms_p99"] = quantile(r.cpu_ms, 0.99);
  j["cpu_ms_max"] = quantile(r.cpu_ms, 1.0);
  j["cpu_ms_mean_with_reading"] = n > 0 ? 1e3 * r.total_cpu_s / n : 0.0;
  if (!error) return j;
  j["ate_m"] = error->rms_m;
  j["path_m"] = error->path_m;
  j["ate_percent"] = 100.0 * error->rms_m / error->path_m;
  j["scale_m_per_unit"] = error->scale_m;
  return j;
}

void write_tum(const fs::path& path, const std::vector<CameraPose>& poses) {
  std::ofstream out(path);
  if (!out) throw std::runtime_error(path.string() + ": cannot be written");
  out << "# t tx ty tz qx qy qz qw (T_V_C, unscaled)\n" << std::fixed;
  out.precision(9);
  for (const CameraPose& p : poses) {
    if (!has_pose(p)) continue;
    const Eigen::Vector3d& t = p.T_V_C.p_V_C;
    const Eigen::Quaterniond& q = p.T_V_C.R_V_C;
    out << Duration{p.time.ns}.seconds() << ' ' << t.x() << ' ' << t.y() << ' ' << t.z() << ' ' << q.x() << ' ' << q.y()
        << ' ' << q.z() << ' ' << q.w() << '\n';
  }
}

}  // namespace

void add_vo_command(CLI::App& app, int& exit_code) {
  struct Options {
    std::string dir, tum;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("vo", "Run the visual odometry alone on a folder of images");
  command->add_option("DIR", options->dir, "Folder with images/, times.txt, calib.txt, perhaps groundtruth.txt")->required();
  command->add_option("--tum", options->tum, "Write the path here (TUM format, unscaled)");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] {
    try {
      const VoRun result = run(options->dir);
      if (!options->tum.empty()) write_tum(options->tum, result.poses);
      const auto report = summary(result, path_error(result.poses, read_truth(fs::path(options->dir) / "groundtruth.txt")));
      if (options->json) {
        std::cout << report.dump(2) << '\n';
      } else {
        for (const auto& [key, value] : report.items()) std::cout << key << ' ' << value << '\n';
      }
    } catch (const std::exception& e) {
      std::cerr << "rfmvo vo: " << e.what() << '\n';
      exit_code = 1;
    }
  });
}

}  // namespace rfmvo
