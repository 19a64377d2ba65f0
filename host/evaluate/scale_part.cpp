#include <algorithm>
#include <cmath>

#include "evaluate/alignment.hpp"
#include "evaluate/parts.hpp"

namespace rfmvo::evaluate {
namespace {

bool has_pose(const CameraPose& pose) {
  return pose.status == VoStatus::kTracking || pose.status == VoStatus::kDegraded;
}

const ScaleEstimate* observable_scale(const LastEstimates& last, std::uint32_t segment) {
  const auto found = last.scales.find(segment);
  return found != last.scales.end() && found->second.observable ? &found->second : nullptr;
}

void add_eq31(const LastEstimates& last, const simulate::Truth& truth, ScaleEvaluation& result) {
  std::vector<double> errors, relative_errors;
  for (std::size_t i = 1; i < last.camera_poses.size(); ++i) {
    const CameraPose& a = last.camera_poses[i - 1];
    const CameraPose& b = last.camera_poses[i];
    const ScaleEstimate* scale = observable_scale(last, b.segment);
    if (!has_pose(a) || !has_pose(b) || a.segment != b.segment || scale == nullptr) continue;
    const auto truth_a = truth_at(truth.trajectory, a.time);
    const auto truth_b = truth_at(truth.trajectory, b.time);
    if (!truth_a || !truth_b) continue;
    const double step_m = (truth_b->t - truth_a->t).norm();
    const double step_v = (b.T_V_C.p_V_C - a.T_V_C.p_V_C).norm();
    if (step_m < kMinStep_m || !(step_v > 0.0)) continue;
    const double ratio = step_m / step_v;
    errors.push_back(std::abs(scale->m_per_unit - ratio));
    relative_errors.push_back(errors.back() / ratio);
  }
  result.eq31_steps = static_cast<int>(errors.size());
  if (const auto summary = summarise(errors)) result.eq31 = summary->mean;
  if (const auto summary = summarise(relative_errors)) result.eq31_relative = summary->mean;
}

std::optional<double> true_scale(const LastEstimates& last, const simulate::Truth& truth, std::uint32_t segment) {
  std::vector<PosePair> pairs;
  for (const CameraPose& pose : last.camera_poses) {
    if (!has_pose(pose) || pose.segment != segment) continue;
    if (const auto T = truth_at(truth.trajectory, pose.time)) {
      pairs.push_back({{pose.T_V_C.R_V_C, pose.T_V_C.p_V_C}, *T});
    }
  }
  const auto similarity = align(pairs, {.with_scale = true});
  return similarity ? std::optional(similarity->scale) : std::nullopt;
}

}  // namespace

ScaleEvaluation evaluate_scale(const LastEstimates& last, const simulate::Truth& truth,
                               const TrajectoryEvaluation& trajectory) {
  ScaleEvaluation result;
  double weighted = 0.0, path_m = 0.0;
  for (const SegmentEvaluation& segment : trajectory.segments) {
    weighted += segment.path_m * std::abs(segment.sim3_scale - 1.0);
    path_m += segment.path_m;
  }
  if (path_m > 0.0) result.relative_error = weighted / path_m;
  add_eq31(last, truth, result);

  const auto longest =
      std::max_element(trajectory.segments.begin(), trajectory.segments.end(),
                       [](const SegmentEvaluation& a, const SegmentEvaluation& b) { return a.path_m < b.path_m; });
  // Without a metric path the scale of the last segment is the one to look at.
  std::optional<std::uint32_t> segment;
  if (longest != trajectory.segments.end())
    segment = longest->segment;
  else if (!last.scales.empty())
    segment = last.scales.rbegin()->first;
  if (!segment) return result;
  const auto found = last.scales.find(*segment);
  if (found != last.scales.end()) result.estimate = found->second;
  result.true_m_per_unit = true_scale(last, truth, *segment);
  return result;
}

}  // namespace rfmvo::evaluate
