// rfmvo vo: the odometry alone on a folder of images or the frames of a journal; its path as a TUM file, its cost,
// its error where the truth is known, and pictures of it at work.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <sstream>

#include "commands/commands.hpp"
#include "commands/overwrite.hpp"
#include "commands/progress_line.hpp"
#include "commands/whole_file.hpp"
#include "edges/camera_file.hpp"
#include "edges/image_folder.hpp"
#include "edges/journal.hpp"
#include "edges/text_file.hpp"
#include "odometry/odometry_report.hpp"
#include "odometry/odometry_view.hpp"

namespace rfmvo {
namespace {

namespace fs = std::filesystem;
using odometry::Run;

struct Options {
  std::string input, camera, truth, tum, settled_tum, json, view;
  bool force = false;
  std::vector<std::string> settings;
  std::string prefix = LcmConfig{}.prefix;
  int threads = 1;
};

Result<std::unique_ptr<EventSource>> open_source(const Options& options) {
  if (fs::is_directory(options.input)) {
    auto folder = ImageFolder::open(options.input);
    if (!folder) return folder.error();
    return std::unique_ptr<EventSource>(std::move(folder).value());
  }
  auto journal = JournalReader::open(options.input, options.prefix, {});
  if (!journal) return journal.error();
  return std::unique_ptr<EventSource>(std::move(journal).value());
}

// --truth may name a TUM file or a folder that holds one; without it, the images' own.
std::string truth_file(const Options& options) {
  const auto within = [](const std::string& folder) -> std::string {
    for (const char* name : {"groundtruth.txt", "trajectory.tum"}) {
      if (fs::exists(fs::path(folder) / name)) return fs::path(folder) / name;
    }
    return "";
  };
  if (options.truth.empty()) return fs::is_directory(options.input) ? within(options.input) : "";
  if (!fs::is_directory(options.truth)) return options.truth;
  const std::string found = within(options.truth);
  return found.empty() ? (fs::path(options.truth) / "trajectory.tum").string() : found;
}

Result<std::vector<simulate::TruePose>> read_truth(const std::string& path) {
  std::vector<simulate::TruePose> truth;
  if (path.empty()) return truth;
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
    const std::string where = path + ":" + std::to_string(number);
    if (!(fields >> t_s >> T.t.x() >> T.t.y() >> T.t.z() >> q[0] >> q[1] >> q[2] >> q[3]) || !(q.norm() > 0.5))
      return Error{ErrorCode::kMalformed, "expects t tx ty tz qx qy qz qw", where};
    const DeviceTime time{Duration::from_seconds(t_s).ns};
    if (!truth.empty() && time <= truth.back().time)
      return Error{ErrorCode::kMalformed, "time does not increase", where};
    T.R.normalize();
    truth.push_back({time, T});
  }
  return truth;
}

Result<Run> run(const Options& options) {
  auto source = open_source(options);
  if (!source) return source.error();
  std::unique_ptr<odometry::ViewWriter> view;
  if (!options.view.empty()) {
    auto created = odometry::ViewWriter::create(options.view);
    if (!created) return created.error();
    view = std::move(created).value();
  }
  const ProgressLine line("");
  std::size_t frames = 0;
  const auto watch = [&](const Frame& frame, const CameraPose& pose, const VisualOdometry& vo) -> Status {
    line.say(std::to_string(++frames) + " frames");
    return view ? view->add(frame, pose, vo) : Status(Done{});
  };
  odometry::RunOptions how{options.settings, std::nullopt};
  if (!options.camera.empty()) {
    const auto camera = read_camera_file(options.camera);
    if (!camera) return camera.error();
    how.camera = camera.value();
  }
  auto result = odometry::run_odometry(*source.value(), how, watch);
  if (!result)
    return result.error().where.empty() ? Error{result.error().code, result.error().what, options.input}
                                        : result.error();
  if (result.value().poses.empty()) return Error{ErrorCode::kMalformed, "holds no frame", options.input};
  if (view) {
    if (const Status s = view->close(); !s) return s.error();
  }
  return result;
}

void print(const nlohmann::ordered_json& figures, const std::string& before = "") {
  for (const auto& [key, value] : figures.items()) {
    if (value.is_object())
      print(value, before + key + ".");
    else
      fmt::print("{:<28} {}\n", before + key, value.dump());
  }
}

Status run_command(const Options& options) {
  const Status free = check_free({options.tum, options.settled_tum, options.json, options.view}, options.force);
  if (!free) return free;
  cv::setNumThreads(options.threads);
  const auto truth = read_truth(truth_file(options));
  if (!truth) return truth.error();
  const auto result = run(options);
  if (!result) return result.error();
  const auto figures = odometry::report(result.value(), truth.value());
  if (!options.tum.empty()) {
    if (const Status s = write_whole_file(options.tum, to_tum(live_path(result.value()))); !s) return s;
  }
  if (!options.settled_tum.empty()) {
    if (const Status s = write_whole_file(options.settled_tum, to_tum(settled_path(result.value()))); !s) return s;
  }
  if (!options.json.empty()) {
    if (const Status s = write_whole_file(options.json, figures.dump(2) + "\n"); !s) return s;
  }
  if (options.json != "/dev/stdout") print(figures);
  return Done{};
}

}  // namespace

void add_vo_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("vo", "Run the visual odometry alone on a folder of images or a journal");
  command->add_option("input", options->input, "Folder with times.txt, calib.txt, images; or a journal (.lcmlog)")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("--camera", options->camera,
                      "Calibration instead of the recorded one: Kalibr, OpenCV or ROS (.yaml), calib.txt, .toml");
  command->add_option("--truth", options->truth,
                      "True path (TUM), or the folder of a simulation's truth; default: groundtruth.txt of the folder");
  command->add_option("--tum", options->tum, "Write the path as it came (TUM format, unscaled)");
  command->add_option("--settled-tum", options->settled_tum, "Write the path after bundle adjustment");
  command->add_option("--json", options->json, "Write the figures to this file");
  command->add_option("--view", options->view, "Draw points and map: FILE.mp4, or FILE.png for the last frame");
  command->add_option("--set", options->settings, "A setting, section.key=value");
  command->add_option("--threads", options->threads, "Of the image processing; the result does not depend on it")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  add_force_option(*command, options->force);
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    const Status status = run_command(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo vo: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
