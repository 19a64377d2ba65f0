// The paper's estimator over a recording, with every antenna array kept.
#pragma once

#include "config/config.hpp"
#include "montecarlo/recording.hpp"
#include "reproduce/results.hpp"

namespace rfmvo::reproduce {

// The pipeline's events go to PaperEstimator itself, as the product's pipeline does.
[[nodiscard]] PaperRun run_paper(const montecarlo::Recording& recording, const Config& config);

// All repairs of docs/paper.md.
void repair(PaperConfig& paper);

}  // namespace rfmvo::reproduce
