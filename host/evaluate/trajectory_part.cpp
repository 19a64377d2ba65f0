#include <cmath>

#include "evaluate/alignment.hpp"
#include "evaluate/parts.hpp"

namespace rfmvo::evaluate {
namespace {

std::vector<PosePair> associate(const Trajectory& trajectory, const std::vector<simulate::TruePose>& truth) {
  std::vector<PosePair> pairs;
  for (const MetricPose& pose : trajectory.poses) {
    if (!pose.T_W_C.t.allFinite() || !pose.T_W_C.R.coeffs().allFinite()) continue;
    if (const auto T = truth_at(truth, pose.time)) pairs.push_back({pose.T_W_C, *T});
  }
  return pairs;
}

std::optional<SegmentEvaluation> evaluate_segment(std::uint32_t segment, const std::vector<PosePair>& pairs) {
  const auto se3 = align(pairs, {});
  const auto sim3 = align(pairs, {.with_scale = true});
  if (!se3 || !sim3) return std::nullopt;

  SegmentEvaluation result;
  result.segment = segment;
  result.poses = static_cast<int>(pairs.size());
  result.ate_se3_m = position_rmse_m(pairs, *se3);
  result.ate_sim3_m = position_rmse_m(pairs, *sim3);
  result.sim3_scale = sim3->scale;
  for (std::size_t i = 1; i < pairs.size(); ++i) result.path_m += (pairs[i].truth.t - pairs[i - 1].truth.t).norm();

  result.aligned_with_orientations = spread_off_line_m(pairs) < kStraightSpread_m;
  const double weight = kOrientationLever_m * kOrientationLever_m;
  const auto for_tags = result.aligned_with_orientations ? align(pairs, {.orientation_weight_m2 = weight}) : se3;
  result.T_truth_W = for_tags ? for_tags->T : se3->T;
  return result;
}

}  // namespace

Result<TrajectoryEvaluation> evaluate_trajectory(const LastEstimates& last, const simulate::Truth& truth) {
  TrajectoryEvaluation result;
  for (std::size_t i = 1; i < truth.trajectory.size(); ++i) {
    result.path_m += (truth.trajectory[i].T_W_C.t - truth.trajectory[i - 1].T_W_C.t).norm();
  }

  std::size_t associated = 0;
  double poses = 0.0, se3 = 0.0, sim3 = 0.0;
  for (const auto& [segment, trajectory] : last.trajectories) {
    const std::vector<PosePair> pairs = associate(trajectory, truth.trajectory);
    associated += pairs.size();
    const auto evaluated = evaluate_segment(segment, pairs);
    if (!evaluated) continue;
    result.segments.push_back(*evaluated);
    poses += evaluated->poses;
    se3 += evaluated->poses * evaluated->ate_se3_m * evaluated->ate_se3_m;
    sim3 += evaluated->poses * evaluated->ate_sim3_m * evaluated->ate_sim3_m;
  }
  if (!last.trajectories.empty() && !truth.trajectory.empty() && associated == 0) {
    return Error{ErrorCode::kOutOfRange, "the path of the result and the true path have no time in common", ""};
  }
  if (poses > 0.0) {
    result.ate_se3_m = std::sqrt(se3 / poses);
    result.ate_sim3_m = std::sqrt(sim3 / poses);
  }
  return result;
}

}  // namespace rfmvo::evaluate
