// Fig. 11 to 13: one parameter of the paper's estimator at a time, errors over all antenna arrays.
#pragma once

#include "config/config.hpp"
#include "montecarlo/recording.hpp"
#include "reproduce/results.hpp"

namespace rfmvo::reproduce {

// L = 20..80 (Fig. 11), angles 1, 2, 5, 10 degrees (Fig. 12), scale 0.05, 0.1, 0.2 (Fig. 13); values only.
[[nodiscard]] std::vector<Sweep> empty_sweeps();

// Each value twice: to the letter and repaired.
[[nodiscard]] std::size_t sweep_points(const std::vector<Sweep>& sweeps);

// Number n of sweep_points. Different numbers may be filled by different threads.
void fill_sweep_point(std::vector<Sweep>& sweeps, std::size_t n, const std::vector<montecarlo::Recording>& recordings,
                      const Config& paper);

}  // namespace rfmvo::reproduce
