// rfmvo vo: the odometry alone on a folder of images; its path as a TUM file, and its error where the
// folder has a groundtruth.txt (TUM: t tx ty tz qx qy qz qw of T_W_C).
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands/commands.hpp"
#include "commands/whole_file.hpp"
#include "config/config_table.hpp"
#include "edges/image_folder.hpp"
#include "edges/text_file.hpp"
#include "evaluate/alignment.hpp"
#include "vision/visual_odometry.hpp"

namespace rfmvo {
namespace {

struct Options {
  std::string folder, tum;
  std::vector<std::string> settings;
  bool json = false;
};

struct Run {
  std::vector<CameraPose> poses;
  std::vector<double> cpu_ms;        // of the odometry, per frame, without reading the image
  double total_cpu_s = 0.0;          // with reading
  double k1 = 0.0, readout_s = 0.0;  // as estimated in the end
};

struct PathError {
  double rms_m = 0.0;
  double path_m = 0.0;
  double scale_m = 0.0;  // metres per unit of V
};

double cpu_seconds() {
  std::timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

bool has_pose(const CameraPose& p) { return p.status == VoStatus::kTracking || p.status == VoStatus::kDegraded; }

Result<Config> configured(const std::vector<std::string>& settings) {
  Config config;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) return Error{ErrorCode::kMalformed, "expects section.key=value", setting};
    const Status s = set_value_from_text(config, setting.substr(0, equals), setting.substr(equals + 1));
    if (!s) return s.error();
  }
  return config;
}

Result<Run> run_odometry(const Options& options) {
  const auto config = configured(options.settings);
  if (!config) return config.error();
  const double begin_s = cpu_seconds();
  auto folder = ImageFolder::open(options.folder);
  if (!folder) return folder.error();
  VisualOdometry odometry(config.value().vision, folder.value()->camera());
  Run run;
  while (true) {
    const auto event = folder.value()->next();
    if (!event) return event.error();
    if (!event.value()) break;
    const Frame* frame = std::get_if<Frame>(&*event.value());
    if (!frame) continue;
    const double before_s = cpu_seconds();
    run.poses.push_back(odometry.on(*frame));
    run.cpu_ms.push_back(1e3 * (cpu_seconds() - before_s));
  }
  run.total_cpu_s = cpu_seconds() - begin_s;
  run.k1 = odometry.lens().camera().radtan[0];
  run.readout_s = odometry.lens().readout_s();
  return run;
}

// Empty if there is no such file.
Result<std::vector<simulate::TruePose>> read_truth(const std::string& path) {
  std::vector<simulate::TruePose> truth;
  if (!std::filesystem::exists(path)) return truth;
  const auto text = read_text_file(path);
  if (!text) return text.error();
  std::istringstream stream(text.value());
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    double t_s = 0.0;
    Rigid3 T;
    auto& q = T.R.coeffs();
    if (!(fields >> t_s >> T.t.x() >> T.t.y() >> T.t.z() >> q[0] >> q[1] >> q[2] >> q[3]))
      return Error{ErrorCode::kMalformed, "expects t tx ty tz qx qy qz qw", path + ":" + std::to_string(number)};
    T.R.normalize();
    truth.push_back({DeviceTime{Duration::from_seconds(t_s).ns}, T});
  }
  return truth;
}

// Of the longest segment, after the similarity that fits it best.
std::optional<PathError> path_error(const std::vector<CameraPose>& poses,
                                    const std::vector<simulate::TruePose>& truth) {
  std::map<std::uint32_t, int> count;
  for (const CameraPose& p : poses) count[p.segment] += has_pose(p);
  if (count.empty() || truth.empty()) return std::nullopt;
  const auto longest =
      std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<evaluate::PosePair> pairs;
  PathError error;
  for (const CameraPose& p : poses) {
    if (!has_pose(p) || p.segment != longest->first) continue;
    const auto T_W_C = evaluate::truth_at(truth, p.time);
    if (!T_W_C) continue;
    if (!pairs.empty()) error.path_m += (T_W_C->t - pairs.back().truth.t).norm();
    pairs.push_back({{p.T_V_C.R_V_C, p.T_V_C.p_V_C}, *T_W_C});
  }
  const auto alignment = evaluate::align(pairs, {.with_scale = true});
  if (!alignment) return std::nullopt;
  error.rms_m = evaluate::position_rmse_m(pairs, *alignment);
  error.scale_m = alignment->scale;
  return error;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

nlohmann::ordered_json figures(const Run& run, const std::optional<PathError>& error) {
  const auto n = static_cast<double>(std::max<std::size_t>(run.poses.size(), 1));
  const auto first = std::find_if(run.poses.begin(), run.poses.end(), has_pose);
  const auto tracked = std::count_if(run.poses.begin(), run.poses.end(), has_pose);
  std::map<std::uint32_t, int> segments;
  nlohmann::ordered_json j;
  int degraded = 0;
  double sum_ms = 0.0;
  for (const CameraPose& p : run.poses) {
    if (has_pose(p)) ++segments[p.segment];
    degraded += p.status == VoStatus::kDegraded;
  }
  for (const double ms : run.cpu_ms) sum_ms += ms;
  j["frames"] = run.poses.size();
  j["tracked"] = tracked;
  j["degraded"] = degraded;
  j["segments"] = segments.size();
  if (first != run.poses.end()) {
    j["start_s"] = (first->time - run.poses.front().time).seconds();
    j["tracked_share_after_start"] = static_cast<double>(tracked) / static_cast<double>(run.poses.end() - first);
  }
  j["cpu_ms_mean"] = sum_ms / n;
  j["cpu_ms_p50"] = quantile(run.cpu_ms, 0.5);
  j["cpu_ms_p99"] = quantile(run.cpu_ms, 0.99);
  j["cpu_ms_max"] = quantile(run.cpu_ms, 1.0);
  j["cpu_ms_mean_with_reading"] = 1e3 * run.total_cpu_s / n;
  j["lens_k1"] = run.k1;
  j["lens_readout_ms"] = 1e3 * run.readout_s;
  if (!error) return j;
  j["ate_m"] = error->rms_m;
  j["path_m"] = error->path_m;
  j["ate_percent"] = 100.0 * error->rms_m / error->path_m;
  j["scale_m_per_unit"] = error->scale_m;
  return j;
}

std::string to_tum(const std::vector<CameraPose>& poses) {
  std::string text = "# t tx ty tz qx qy qz qw: T_V_C, unscaled; every segment has a V of its own\n";
  for (const CameraPose& p : poses) {
    if (!has_pose(p)) continue;
    const Eigen::Vector3d& t = p.T_V_C.p_V_C;
    const Eigen::Quaterniond& q = p.T_V_C.R_V_C;
    text += fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", Duration{p.time.ns}.seconds(),
                        t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

Status run_command(const Options& options) {
  const auto truth = read_truth(options.folder + "/groundtruth.txt");
  if (!truth) return truth.error();
  const auto run = run_odometry(options);
  if (!run) return run.error();
  if (!options.tum.empty()) {
    if (const Status s = write_whole_file(options.tum, to_tum(run.value().poses)); !s) return s;
  }
  const auto report = figures(run.value(), path_error(run.value().poses, truth.value()));
  if (options.json) {
    fmt::print("{}\n", report.dump(2));
    return Done{};
  }
  for (const auto& [key, value] : report.items()) fmt::print("{:<26} {}\n", key, value.dump());
  return Done{};
}

}  // namespace

void add_vo_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("vo", "Run the visual odometry alone on a folder of images");
  command->add_option("folder", options->folder, "Folder with times.txt, calib.txt, images, perhaps groundtruth.txt")
      ->required();
  command->add_option("--tum", options->tum, "Write the path to this file (TUM format, unscaled)");
  command->add_option("--set", options->settings, "A setting, section.key=value");
  command->add_flag("--json", options->json, "Print the figures as JSON");
  command->callback([options, &exit_code] {
    const Status status = run_command(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo vo: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
