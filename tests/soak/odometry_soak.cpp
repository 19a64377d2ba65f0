// `make soak`: the odometry on half an hour of rendered driving; its resident memory and CPU time, minute by minute.
// The frames come through a pipe from a process that renders them, whose textures would count otherwise. Fails if
// memory exceeds the bound or grows after the first minutes.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <type_traits>
#include <vector>

#include "edges/lcm_codec.hpp"
#include "simulate/simulation.hpp"
#include "vision/visual_odometry.hpp"

namespace rfmvo {
namespace {

constexpr double kMost_mb = 200.0;
constexpr std::size_t kSettled_min = 3;  // the archive of key frames is full by then
constexpr double kMostGrowth = 0.05;     // from then on

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double size_pages = 0.0, resident_pages = 0.0;
  statm >> size_pages >> resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

double cpu_s() {
  std::timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

class Soak {
 public:
  explicit Soak(const CameraModel& camera) : odometry_(VisionConfig{}, camera) {}

  void on(const Frame& frame) {
    if (!begin_) begin_ = frame.time;
    const double before_s = cpu_s();
    const CameraPose pose = odometry_.on(frame);
    vo_cpu_s_ += cpu_s() - before_s;
    ++frames_;
    tracked_ += pose.status == VoStatus::kTracking || pose.status == VoStatus::kDegraded;
    if ((frame.time - *begin_).seconds() >= 60.0 * static_cast<double>(resident_mb_.size() + 1)) report(pose);
  }

  [[nodiscard]] bool passed() const {
    const auto most = std::max_element(resident_mb_.begin(), resident_mb_.end());
    if (most == resident_mb_.end() || *most > kMost_mb) return false;
    return resident_mb_.size() <= kSettled_min || *most <= (1.0 + kMostGrowth) * resident_mb_[kSettled_min - 1];
  }

 private:
  void report(const CameraPose& pose) {
    resident_mb_.push_back(resident_mb());
    fmt::print("minute {:2}: {:6.1f} MB resident, {:.2f} ms of CPU per frame, {:.1f} % tracked, segment {}\n",
               resident_mb_.size(), resident_mb_.back(), 1e3 * vo_cpu_s_ / frames_, 100.0 * tracked_ / frames_,
               pose.segment);
    std::fflush(stdout);
  }

  VisualOdometry odometry_;
  std::optional<DeviceTime> begin_;
  std::vector<double> resident_mb_;
  double vo_cpu_s_ = 0.0;
  int frames_ = 0, tracked_ = 0;
};

static_assert(std::is_trivially_copyable_v<CameraModel> && std::is_trivially_copyable_v<DeviceTime>);

template <typename T>
bool put(std::FILE* pipe, const T& value) {
  return std::fwrite(&value, sizeof(value), 1, pipe) == 1;
}

template <typename T>
bool get(std::FILE* pipe, T& value) {
  return std::fread(&value, sizeof(value), 1, pipe) == 1;
}

// Into the pipe: the camera, then time and grey values of each frame.
int render(const simulate::Options& options, std::FILE* pipe) {
  const auto truth = simulate::simulate(options, [pipe](const Event& event) -> Status {
    bool ok = true;
    if (const auto* start = std::get_if<Start>(&event)) ok = put(pipe, start->calibration.camera);
    if (const auto* picture = std::get_if<Frame>(&event)) {
      Frame frame = *picture;
      if (const Status s = decode_image(frame); !s) return s;
      ok = put(pipe, frame.time) && std::fwrite(frame.grey->data(), frame.grey->size(), 1, pipe) == 1;
    }
    return ok ? Status(Done{}) : Status(Error{ErrorCode::kUnwritable, "nobody reads the frames", "pipe"});
  });
  std::fclose(pipe);
  if (!truth.ok()) fmt::print(stderr, "odometry_soak: {}\n", truth.error().text());
  return truth.ok() ? 0 : 1;
}

bool watch(std::FILE* pipe) {
  CameraModel camera;
  if (!get(pipe, camera)) return false;
  Soak soak(camera);
  const auto size = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  Frame frame;
  frame.width_px = camera.width_px, frame.height_px = camera.height_px;
  while (get(pipe, frame.time)) {
    auto grey = std::make_shared<std::vector<std::uint8_t>>(size);
    if (std::fread(grey->data(), size, 1, pipe) != 1) return false;
    frame.grey = std::move(grey);
    soak.on(frame);
  }
  return soak.passed();
}

}  // namespace
}  // namespace rfmvo

int main(int argc, char** argv) {
  CLI::App app("Half an hour of rendered driving: does the odometry's memory stay flat?");
  double minutes = 30.0;
  rfmvo::simulate::Options options;
  options.scene = "shelf05";
  app.add_option("--minutes", minutes, "Of driving")->check(CLI::Range(1.0, 120.0))->capture_default_str();
  app.add_option("--scene", options.scene, "A rendered drive")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  options.duration_s = 60.0 * minutes + 1.0;
  int ends[2] = {-1, -1};
  const pid_t renderer = pipe(ends) == 0 ? fork() : -1;
  if (renderer < 0) {
    fmt::print(stderr, "odometry_soak: no second process: {}\n", std::strerror(errno));
    return 1;
  }
  cv::setNumThreads(1);
  close(ends[renderer == 0 ? 0 : 1]);
  if (renderer == 0) return rfmvo::render(options, fdopen(ends[1], "wb"));
  const bool flat = rfmvo::watch(fdopen(ends[0], "rb"));
  int status = 0;
  waitpid(renderer, &status, 0);
  const bool ok = flat && status == 0;
  fmt::print("{}\n", ok ? "flat" : "NOT flat, or no frames");
  return ok ? 0 : 1;
}
