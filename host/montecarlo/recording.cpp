#include "montecarlo/recording.hpp"

#include <chrono>

#include "config/config_table.hpp"
#include "edges/lcm_codec.hpp"
#include "edges/toml_files.hpp"
#include "estimator/pipeline.hpp"
#include "montecarlo/cpu_time.hpp"
#include "vision/visual_odometry.hpp"

namespace rfmvo::montecarlo {
namespace {

double wall_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

Result<std::vector<CameraPose>> odometry_of(const simulate::Options& options) {
  simulate::Options with_frames = options;
  with_frames.frames = true;
  std::optional<VisualOdometry> odometry;
  std::vector<CameraPose> poses;
  const auto truth = simulate::simulate(with_frames, [&](const Event& event) -> Status {
    if (const auto* start = std::get_if<Start>(&event)) {
      if (start->config.estimator.pose_source != "frames")
        return Error{ErrorCode::kUnsupported, "the scene has no frames", "--from frames"};
      odometry.emplace(start->config.vision, start->calibration.camera);
    } else if (const auto* frame = std::get_if<Frame>(&event)) {
      Frame decoded = *frame;
      if (const Status status = decode_image(decoded); !status) return status;
      poses.push_back(odometry->on(decoded));
    }
    return Done{};
  });
  if (!truth) return truth.error();
  return poses;
}

// Frames and simulated poses have the same times, so one pose takes the place of the other.
Result<Recording> record(const simulate::Options& options, const std::vector<CameraPose>* odometry) {
  simulate::Options without_frames = options;
  without_frames.frames = false;
  Recording recording;
  std::size_t next = 0;
  auto truth = simulate::simulate(without_frames, [&](const Event& event) -> Status {
    if (odometry == nullptr || !std::holds_alternative<CameraPose>(event)) {
      recording.events.push_back(event);
    } else if (next < odometry->size()) {
      recording.events.emplace_back((*odometry)[next++]);
    }
    return Done{};
  });
  if (!truth) return truth.error();
  recording.truth = std::move(truth).value();
  return recording;
}

Result<Config> config_for(const Config& recorded, const Options& options) {
  auto read = parse_config(options.config_toml, options.config_name, recorded);
  if (!read) return read.error();
  Config config = std::move(read).value();
  config.estimator.kind = options.estimator;
  config.estimator.pose_source = "poses";
  if (const Status s = check_consistency(config); !s) return s.error();
  return config;
}

std::vector<Estimate> estimate(const Recording& recording, const Config& config, Timing& timing) {
  Pipeline pipeline;
  std::vector<Estimate> estimates;
  const auto keep = [&](std::span<const Estimate> some) {
    estimates.insert(estimates.end(), some.begin(), some.end());
  };
  const double cpu_before_s = thread_cpu_s();
  for (const Event& event : recording.events) {
    const double before_s = wall_s();
    if (const auto* start = std::get_if<Start>(&event))
      keep(pipeline.on(Start{start->time, config, start->calibration}));
    else
      keep(pipeline.on(event));
    const double took_s = wall_s() - before_s;
    timing.wall_s += took_s;
    if (std::holds_alternative<TagRead>(event)) timing.read_s.push_back(took_s);
  }
  const double before_s = wall_s();
  keep(pipeline.finish());
  timing.wall_s += wall_s() - before_s;
  timing.cpu_s = thread_cpu_s() - cpu_before_s;
  timing.span_s = (time_of(recording.events.back()) - time_of(recording.events.front())).seconds();
  return estimates;
}

}  // namespace rfmvo::montecarlo
