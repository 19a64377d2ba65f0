#include "montecarlo/experiment.hpp"

#include "montecarlo/recording.hpp"

namespace rfmvo::montecarlo {
namespace {

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
  result.lobes = bound::lobes_of(world.value(), *result.bound);
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
  std::vector<std::optional<SeedRun>> results(options.seeds);
  const auto work = [&](std::size_t i) -> Status {
    auto result = run_seed(options, options.first_seed + i, odometry.value());
    if (!result) {
      const Error& error = result.error();
      return Error{error.code, "seed " + std::to_string(options.first_seed + i) + ": " + error.what, error.where};
    }
    results[i] = std::move(result).value();
    return Done{};
  };
  if (const Status status = in_parallel(options.seeds, options.jobs, work, progress); !status) return status.error();
  std::vector<SeedRun> runs;
  for (auto& result : results) runs.push_back(std::move(*result));
  return runs;
}

}  // namespace rfmvo::montecarlo
