// `make soak`: the odometry on half an hour of rendered driving, frames handed over in memory; resident memory and CPU
// time, minute by minute. Fails if memory exceeds the bound or grows after the first minutes.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <fstream>
#include <opencv2/core/utility.hpp>
#include <optional>
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
  Status on(const Event& event) {
    if (const auto* start = std::get_if<Start>(&event))
      odometry_.emplace(start->config.vision, start->calibration.camera);
    const auto* picture = std::get_if<Frame>(&event);
    if (!picture) return Done{};
    Frame frame = *picture;
    if (const Status s = decode_image(frame); !s) return s;
    if (!begin_) begin_ = frame.time;
    const double before_s = cpu_s();
    const CameraPose pose = odometry_->on(frame);
    vo_cpu_s_ += cpu_s() - before_s;
    ++frames_;
    tracked_ += pose.status == VoStatus::kTracking || pose.status == VoStatus::kDegraded;
    if ((frame.time - *begin_).seconds() >= 60.0 * static_cast<double>(resident_mb_.size() + 1)) report(pose);
    return Done{};
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

  std::optional<VisualOdometry> odometry_;
  std::optional<DeviceTime> begin_;
  std::vector<double> resident_mb_;
  double vo_cpu_s_ = 0.0;
  int frames_ = 0, tracked_ = 0;
};

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
  cv::setNumThreads(1);
  options.duration_s = 60.0 * minutes + 1.0;
  rfmvo::Soak soak;
  const auto truth = rfmvo::simulate::simulate(options, [&soak](const rfmvo::Event& event) { return soak.on(event); });
  if (!truth.ok()) {
    fmt::print(stderr, "odometry_soak: {}\n", truth.error().text());
    return 1;
  }
  fmt::print("{}\n", soak.passed() ? "flat" : "NOT flat");
  return soak.passed() ? 0 : 1;
}
