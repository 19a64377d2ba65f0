// All methods on the same simulated runs.
#pragma once

#include "base/result.hpp"
#include "montecarlo/workers.hpp"
#include "reproduce/results.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::reproduce {

struct Options {
  std::size_t runs = 30;
  std::size_t jobs = 2;  // the results do not depend on it, run times aside
  std::uint64_t first_seed = 1;
  std::size_t sweep_runs = 5;     // runs that Fig. 11 to 13 and the easier walls are measured on
  std::size_t tags = 0;           // 0: the scene's own eight
  std::int64_t array_stride = 1;  // reads between two antenna arrays of the paper's estimator: 1 there
  std::string images_dir;         // of a real image sequence; empty: the wall only
};

// Errors: as simulate(); the images.
[[nodiscard]] Result<Results> reproduce(const Options& options, const montecarlo::Progress& progress);

}  // namespace rfmvo::reproduce
