#include "montecarlo/experiment.hpp"

#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "estimator/pipeline.hpp"
#include "montecarlo/recording.hpp"

namespace rfmvo::montecarlo {
namespace {

double thread_cpu_s() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double wall_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

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

Result<evaluate::Evaluation> judge(const Recording& recording, const Options& options, Timing& timing) {
  const auto config = config_for(std::get<Start>(recording.events.front()).config, options);
  if (!config) return config.error();
  return evaluate::evaluate(estimate(recording, config.value(), timing), recording.truth);
}

// Tells the estimator that the path is the true one, but for its unit: a tenth of a millimetre, almost no drift.
void trust_path(JointConfig& joint) {
  joint.vo_scale_walk_per_sqrt_m = 1e-5;
  joint.vo_rotation_walk_deg_per_sqrt_m = 1e-3;
  joint.vo_position_walk_m_per_sqrt_m = 1e-5;
  joint.vo_position_sigma_m = 1e-4;
}

Result<evaluate::Evaluation> judge_known_path(const Options& options, const simulate::Options& simulation) {
  simulate::Options perfect = simulation;
  perfect.vo_class = "PERFECT";
  const auto recording = record(perfect, nullptr);
  if (!recording) return recording.error();
  auto read = config_for(std::get<Start>(recording.value().events.front()).config, options);
  if (!read) return read.error();
  Config config = std::move(read).value();
  trust_path(config.joint);
  Timing ignored;
  return evaluate::evaluate(estimate(recording.value(), config, ignored), recording.value().truth);
}

void add_bounds(const simulate::Options& simulation, SeedRun& result) {
  const auto world = bound::world_of(simulation);
  if (!world) return;
  bound::Settings settings = bound::settings_for(simulation);
  result.bound = bound::bound_of(world.value(), settings);
  settings.known_path = true;
  if (result.known_path) result.known_path_bound = bound::bound_of(world.value(), settings);
}

Result<SeedRun> run_seed(const Options& options, std::uint64_t seed, const std::vector<CameraPose>& shared_odometry) {
  simulate::Options simulation = options.simulation;
  simulation.seed = seed;
  std::vector<CameraPose> odometry = shared_odometry;
  if (options.own_odometry && odometry.empty()) {
    auto made = odometry_of(simulation);
    if (!made) return made.error();
    odometry = std::move(made).value();
  }
  const auto recording = record(simulation, options.own_odometry ? &odometry : nullptr);
  if (!recording) return recording.error();
  SeedRun result;
  result.seed = seed;
  auto evaluation = judge(recording.value(), options, result.timing);
  if (!evaluation) return evaluation.error();
  result.evaluation = std::move(evaluation).value();
  result.reads = result.timing.read_s.size();
  if (options.known_path) {
    auto known = judge_known_path(options, simulation);
    if (!known) return known.error();
    result.known_path = std::move(known).value();
  }
  add_bounds(simulation, result);
  return result;
}

// Recorded frames are the same for every seed; rendered ones are not.
Result<std::vector<CameraPose>> odometry_of_all(const Options& options) {
  if (!options.own_odometry || options.simulation.images_dir.empty()) return std::vector<CameraPose>{};
  return odometry_of(options.simulation);
}

}  // namespace

Result<std::vector<SeedRun>> run(const Options& options, const Progress& progress) {
  const auto odometry = odometry_of_all(options);
  if (!odometry) return odometry.error();
  std::vector<std::optional<Result<SeedRun>>> results(options.seeds);
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::mutex telling;
  std::size_t done = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < options.seeds && !failed; i = next++) {
      results[i].emplace(run_seed(options, options.first_seed + i, odometry.value()));
      if (!results[i]->ok()) failed = true;
      const std::lock_guard lock(telling);
      progress(++done, options.seeds);
    }
  };
  {
    std::vector<std::jthread> workers;
    for (std::size_t j = 0; j < std::min(options.jobs, options.seeds); ++j) workers.emplace_back(work);
  }  // joins
  std::vector<SeedRun> runs;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!results[i]) continue;  // not begun when another failed
    if (!results[i]->ok()) {
      const Error& error = results[i]->error();
      return Error{error.code, "seed " + std::to_string(options.first_seed + i) + ": " + error.what, error.where};
    }
    runs.push_back(std::move(*results[i]).value());
  }
  return runs;
}

}  // namespace rfmvo::montecarlo
