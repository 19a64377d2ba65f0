// The same run over many seeds: simulate, estimate, evaluate, in process.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "bound/bound.hpp"
#include "bound/lobes.hpp"
#include "evaluate/evaluation.hpp"
#include "montecarlo/workers.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::montecarlo {

struct Options {
  simulate::Options simulation;  // its seed is replaced
  std::uint64_t first_seed = 1;
  std::size_t seeds = 10;
  std::size_t jobs = 1;             // worker threads; the result does not depend on them
  std::string estimator = "joint";  // joint | paper
  bool own_odometry = false;        // from frames; else the simulated drifting camera poses
  bool known_path = false;          // estimate once more with the true path (its unit unknown), and told so
  std::string config_toml;          // over the defaults; content, not a path
  std::string config_name;          // of that content, for errors
};

// Of the estimator only; odometry is apart. Not reproducible, unlike everything else.
struct Timing {
  double span_s = 0.0;         // duration of the events
  double wall_s = 0.0;         // in Pipeline::on and finish
  double cpu_s = 0.0;          // the same, of the thread
  std::vector<double> read_s;  // wall time of Pipeline::on for each TagRead
};

struct SeedRun {
  std::uint64_t seed = 0;
  std::size_t reads = 0;
  evaluate::Evaluation evaluation;
  std::optional<evaluate::Evaluation> known_path;
  // Nothing: this kind of run has none (bound/world.hpp); the second one only with known_path.
  std::optional<bound::Bound> bound, known_path_bound;
  std::optional<bound::Lobes> lobes;  // beside `bound`
  Timing timing;
};

// In order of the seeds. The first error by seed ends the experiment.
[[nodiscard]] Result<std::vector<SeedRun>> run(const Options& options, const Progress& progress);

}  // namespace rfmvo::montecarlo
