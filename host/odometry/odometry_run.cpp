#include "odometry/odometry_run.hpp"

#include <sys/resource.h>

#include <ctime>

#include "config/config_table.hpp"
#include "edges/lcm_codec.hpp"

namespace rfmvo::odometry {
namespace {

double cpu_seconds() {
  std::timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux: KiB
}

Result<Config> configured(Config config, const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) return Error{ErrorCode::kMalformed, "expects section.key=value", setting};
    const Status s = set_value_from_text(config, setting.substr(0, equals), setting.substr(equals + 1));
    if (!s) return s.error();
  }
  return config;
}

class Runner {
 public:
  Runner(const RunOptions& options, const Watch& watch) : options_(options), watch_(watch) {}

  Status on(const Start& start) {
    finish();
    const auto config = configured(start.config, options_.settings);
    if (!config) return config.error();
    odometry_ = std::make_unique<VisualOdometry>(config.value().vision,
                                                 options_.camera ? *options_.camera : start.calibration.camera);
    return Done{};
  }

  Status on(Frame frame) {
    if (!odometry_) return Error{ErrorCode::kMalformed, "holds a frame before the calibration (START)", ""};
    if (!frame.grey) {
      if (const Status s = decode_image(frame); !s) return s;
    }
    const double before_s = cpu_seconds();
    run.poses.push_back(odometry_->on(frame));
    run.cpu_ms.push_back(1e3 * (cpu_seconds() - before_s));
    run.settled.insert(run.settled.end(), odometry_->settled().begin(), odometry_->settled().end());
    return watch_ ? watch_(frame, run.poses.back(), *odometry_) : Status(Done{});
  }

  void finish() {
    if (!odometry_) return;
    const auto rest = odometry_->finish();
    run.settled.insert(run.settled.end(), rest.begin(), rest.end());
    run.k1 = k1_of(odometry_->lens().camera());
    run.readout_s = odometry_->lens().readout_s();
    odometry_.reset();
  }

  Run run;

 private:
  const RunOptions& options_;
  const Watch& watch_;
  std::unique_ptr<VisualOdometry> odometry_;
};

}  // namespace

Result<Run> run_odometry(EventSource& source, const RunOptions& options, const Watch& watch) {
  const double begin_s = cpu_seconds();
  Runner runner(options, watch);
  while (true) {
    auto event = source.next();
    if (!event) return event.error();
    if (!event.value()) break;
    Status status = Done{};
    if (const auto* start = std::get_if<Start>(&*event.value())) status = runner.on(*start);
    if (auto* frame = std::get_if<Frame>(&*event.value())) status = runner.on(std::move(*frame));
    if (!status) return status.error();
  }
  runner.finish();
  runner.run.total_cpu_s = cpu_seconds() - begin_s;
  runner.run.peak_memory_mb = peak_memory_mb();
  return std::move(runner.run);
}

}  // namespace rfmvo::odometry
