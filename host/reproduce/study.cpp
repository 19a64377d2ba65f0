#include "reproduce/study.hpp"

#include <algorithm>
#include <optional>

#include "baselines/known_reads.hpp"
#include "baselines/mobitagbot.hpp"
#include "baselines/tagoram.hpp"
#include "evaluate/alignment.hpp"
#include "evaluate/last_estimates.hpp"
#include "montecarlo/cpu_time.hpp"
#include "montecarlo/recording.hpp"
#include "reproduce/conditions.hpp"
#include "reproduce/paper_run.hpp"
#include "reproduce/run_times.hpp"
#include "reproduce/scale_windows.hpp"
#include "reproduce/sweeps.hpp"

namespace rfmvo::reproduce {
namespace {

struct Scene {
  simulate::Options simulation;
  std::int64_t array_stride = 1;
  std::vector<CameraPose> odometry;  // from real frames; empty: simulated poses
};

Result<montecarlo::Recording> record(const Scene& scene, std::uint64_t seed) {
  simulate::Options simulation = scene.simulation;
  simulation.seed = seed;
  return montecarlo::record(simulation, scene.odometry.empty() ? nullptr : &scene.odometry);
}

Result<Config> config_of(const montecarlo::Recording& recording, const char* estimator) {
  montecarlo::Options options;
  options.estimator = estimator;
  return montecarlo::config_for(std::get<Start>(recording.events.front()).config, options);
}

Result<Config> paper_config_of(const montecarlo::Recording& recording, std::int64_t array_stride) {
  auto made = config_of(recording, "paper");
  if (!made) return made.error();
  Config config = std::move(made).value();
  config.paper.array_stride = array_stride;
  return config;
}

Status add_joint(const montecarlo::Recording& recording, Run& run) {
  const auto config = config_of(recording, "joint");
  if (!config) return config.error();
  montecarlo::Timing timing;
  const std::vector<Estimate> estimates = montecarlo::estimate(recording, config.value(), timing);
  const auto evaluation = evaluate::evaluate(estimates, recording.truth);
  if (!evaluation) return evaluation.error();
  for (const auto& tag : evaluation.value().tags.tags)
    run.joint_error_m.push_back(tag.located ? tag.camera_relative_error_m : std::nullopt);
  const evaluate::LastEstimates last = evaluate::last_of(estimates);
  for (const auto& [segment, trajectory] : last.trajectories) {
    const auto errors = window_scale_errors(trajectory.poses, last.camera_poses, recording.truth.trajectory);
    run.joint_scale.insert(run.joint_scale.end(), errors.begin(), errors.end());
    for (const MetricPose& pose : trajectory.poses) run.joint_path_m.push_back(pose.T_W_C.t);
  }
  run.joint_cpu_s = timing.cpu_s;
  run.span_s = timing.span_s;
  run.reads = timing.read_s.size();
  return Done{};
}

using Locate = baselines::HologramPeak (*)(std::span<const baselines::KnownRead>, const baselines::Region&);

// CPU seconds of all tags.
double add_baseline(const montecarlo::Recording& recording, Locate locate,
                    std::vector<std::optional<BaselineTag>>& tags) {
  const auto by_tag = baselines::known_reads(recording.events, recording.truth);
  const double before_s = montecarlo::thread_cpu_s();
  for (const simulate::TrueTag& tag : recording.truth.tags) {
    const auto reads = by_tag.find(tag.epc);
    tags.emplace_back();
    if (reads == by_tag.end() || reads->second.size() < 2) continue;
    const baselines::HologramPeak peak = locate(reads->second, {.centre_m = tag.p_W_X_m});
    tags.back() = BaselineTag{(peak.p_W_X_m - tag.p_W_X_m).norm(), peak.at_edge};
  }
  return montecarlo::thread_cpu_s() - before_s;
}

Result<Run> run_seed(const Scene& scene, std::uint64_t seed) {
  const auto recording = record(scene, seed);
  if (!recording) return recording.error();
  const auto paper = paper_config_of(recording.value(), scene.array_stride);
  if (!paper) return paper.error();
  Config repaired = paper.value();
  repair(repaired.paper);
  Run run;
  run.seed = seed;
  if (const Status s = add_joint(recording.value(), run); !s) return s.error();
  run.paper = run_paper(recording.value(), paper.value());
  run.repaired = run_paper(recording.value(), repaired);
  run.tagoram_cpu_s = add_baseline(recording.value(), baselines::locate_by_tagoram, run.tagoram);
  run.mobitagbot_cpu_s = add_baseline(recording.value(), baselines::locate_by_mobitagbot, run.mobitagbot);
  for (const simulate::TruePose& pose : recording.value().truth.trajectory) run.true_path_m.push_back(pose.T_W_C.t);
  return run;
}

// Pieces of work of all parts, counted together.
class Counter {
 public:
  Counter(std::size_t all, const montecarlo::Progress& progress) : all_(all), progress_(progress) {}

  // Of the next part, which has `pieces`.
  [[nodiscard]] montecarlo::Progress next(std::size_t pieces) {
    const std::size_t before = before_;
    before_ += pieces;
    return [this, before](std::size_t done, std::size_t) { progress_(before + done, all_); };
  }

 private:
  std::size_t all_, before_ = 0;
  const montecarlo::Progress& progress_;
};

Result<Study> study(const Scene& scene, const Options& options, Counter& counter) {
  std::vector<std::optional<Run>> runs(options.runs);
  const auto work = [&](std::size_t i) -> Status {
    auto run = run_seed(scene, options.first_seed + i);
    if (!run) return run.error();
    runs[i] = std::move(run).value();
    return Done{};
  };
  const Status status = montecarlo::in_parallel(options.runs, options.jobs, work, counter.next(options.runs));
  if (!status) return status.error();
  Study study;
  study.scene = scene.simulation.images_dir.empty() ? scene.simulation.scene : scene.simulation.images_dir;
  for (auto& run : runs) study.runs.push_back(std::move(*run));
  return study;
}

Status add_sweeps(const Scene& wall, const Options& options, Counter& counter, Results& results) {
  results.sweeps = empty_sweeps();
  if (results.sweep_runs == 0) return Done{};
  std::vector<montecarlo::Recording> recordings;
  for (std::size_t i = 0; i < results.sweep_runs; ++i) {
    auto recording = record(wall, options.first_seed + i);
    if (!recording) return recording.error();
    recordings.push_back(std::move(recording).value());
  }
  const auto config = paper_config_of(recordings.front(), options.array_stride);
  if (!config) return config.error();
  const std::size_t points = sweep_points(results.sweeps);
  return montecarlo::in_parallel(
      points, options.jobs,
      [&](std::size_t n) -> Status {
        fill_sweep_point(results.sweeps, n, recordings, config.value());
        return Done{};
      },
      counter.next(points));
}

Status add_conditions(const Scene& wall, const Options& options, Counter& counter, Results& results) {
  if (results.sweep_runs == 0) return Done{};
  results.conditions = empty_conditions();
  const auto work = [&](std::size_t n) -> Status {
    ConditionRuns runs;
    for (std::size_t i = 0; i < results.sweep_runs; ++i) {
      const auto recording =
          record({simulation_of(n, wall.simulation), options.array_stride, {}}, options.first_seed + i);
      if (!recording) return recording.error();
      const auto paper = paper_config_of(recording.value(), options.array_stride);
      if (!paper) return paper.error();
      runs.add(recording.value(), paper.value());
    }
    runs.finish(results.conditions[n]);
    return Done{};
  };
  const std::size_t count = results.conditions.size();
  return montecarlo::in_parallel(count, options.jobs, work, counter.next(count));
}

}  // namespace

Result<Results> reproduce(const Options& options, const montecarlo::Progress& progress) {
  Scene wall;
  wall.array_stride = options.array_stride;
  wall.simulation.scene = "wall";
  wall.simulation.tags = options.tags;
  const bool frames = !options.images_dir.empty();
  Results results;
  results.sweep_runs = std::min(options.sweep_runs, options.runs);
  const std::size_t settings = results.sweep_runs == 0 ? 0 : sweep_points(empty_sweeps()) + empty_conditions().size();
  Counter counter(options.runs * (frames ? 2 : 1) + settings, progress);
  auto wall_study = study(wall, options, counter);
  if (!wall_study) return wall_study.error();
  results.wall = std::move(wall_study).value();
  if (const Status s = add_sweeps(wall, options, counter, results); !s) return s.error();
  if (const Status s = add_conditions(wall, options, counter, results); !s) return s.error();
  if (frames) {
    Scene real;
    real.array_stride = options.array_stride;
    real.simulation.images_dir = options.images_dir;
    real.simulation.tags = options.tags;
    auto odometry = montecarlo::odometry_of(real.simulation);
    if (!odometry) return odometry.error();
    real.odometry = std::move(odometry).value();
    auto real_study = study(real, options, counter);
    if (!real_study) return real_study.error();
    results.real_frames = std::move(real_study).value();
  }
  const auto recording = record(wall, options.first_seed);
  if (!recording) return recording.error();
  const auto config = config_of(recording.value(), "paper");
  if (!config) return config.error();
  results.run_times = time_stages(recording.value(), config.value(), results.wall);
  return results;
}

}  // namespace rfmvo::reproduce
