// Seconds of one core for each stage, on reads of a recorded run.
#pragma once

#include "config/config.hpp"
#include "montecarlo/recording.hpp"
#include "reproduce/results.hpp"

namespace rfmvo::reproduce {

// Stages of the paper's estimator on the first tag that filled an array on every antenna, with the paper's grid (5
// degrees, gamma 0.5 to 2.0 by 0.1 of the true scale); of the joint estimator and the baselines from the study's runs.
[[nodiscard]] std::vector<RunTime> time_stages(const montecarlo::Recording& recording, const Config& paper,
                                               const Study& study);

}  // namespace rfmvo::reproduce
