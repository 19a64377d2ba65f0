#include "evaluate/evaluation.hpp"

#include <algorithm>
#include <cmath>

#include "evaluate/last_estimates.hpp"
#include "evaluate/parts.hpp"

namespace rfmvo::evaluate {

std::optional<Summary> summarise(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  Summary summary;
  for (const double v : values) {
    summary.mean += v / static_cast<double>(n);
    summary.rmse += v * v / static_cast<double>(n);
  }
  summary.rmse = std::sqrt(summary.rmse);
  summary.median = n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
  summary.max = values.back();
  return summary;
}

Result<Evaluation> evaluate(const std::vector<Estimate>& estimates, const simulate::Truth& truth) {
  if (truth.tags.empty() && truth.trajectory.empty()) {
    return Error{ErrorCode::kMalformed, "the truth has neither tags nor a path", ""};
  }
  const LastEstimates last = last_of(estimates);

  Result<TrajectoryEvaluation> trajectory = evaluate_trajectory(last, truth);
  if (!trajectory) return trajectory.error();

  Evaluation result;
  result.trajectory = std::move(trajectory).value();
  result.tags = evaluate_tags(last, truth, result.trajectory);
  result.scale = evaluate_scale(last, truth, result.trajectory);
  return result;
}

}  // namespace rfmvo::evaluate
