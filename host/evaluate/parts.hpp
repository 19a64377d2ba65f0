// The three parts of evaluate(); see evaluation.hpp for what the numbers mean.
#pragma once

#include "evaluate/evaluation.hpp"
#include "evaluate/last_estimates.hpp"

namespace rfmvo::evaluate {

[[nodiscard]] Result<TrajectoryEvaluation> evaluate_trajectory(const LastEstimates& last, const simulate::Truth& truth);
[[nodiscard]] TagsEvaluation evaluate_tags(const LastEstimates& last, const simulate::Truth& truth,
                                           const TrajectoryEvaluation& trajectory);
[[nodiscard]] ScaleEvaluation evaluate_scale(const LastEstimates& last, const simulate::Truth& truth,
                                             const TrajectoryEvaluation& trajectory);

}  // namespace rfmvo::evaluate
