// The events of one seed, ready for the estimator, and the truth beside them.
#pragma once

#include <vector>

#include "estimator/estimate.hpp"
#include "montecarlo/experiment.hpp"

namespace rfmvo::montecarlo {

struct Recording {
  std::vector<Event> events;  // camera poses instead of frames
  simulate::Truth truth;
};

// Own odometry over the frames of a simulated run. What `replay --from frames` computes, once for all.
// Errors: the scene has no frames; a frame that cannot be read.
[[nodiscard]] Result<std::vector<CameraPose>> odometry_of(const simulate::Options& options);

// `odometry` null: the simulated camera poses.
[[nodiscard]] Result<Recording> record(const simulate::Options& options, const std::vector<CameraPose>* odometry);

// Config of a run: its own, with the options' over it.
[[nodiscard]] Result<Config> config_for(const Config& recorded, const Options& options);

// Everything the estimator says about the recording, to the end; adds to `timing`.
[[nodiscard]] std::vector<Estimate> estimate(const Recording& recording, const Config& config, Timing& timing);

}  // namespace rfmvo::montecarlo
