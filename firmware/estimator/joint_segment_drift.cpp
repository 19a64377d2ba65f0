// JointSegment: how strongly the odometry drifts.
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "estimator/joint_segment.hpp"

namespace rfmvo {

// Random-walk strengths of the odometry from the corrections themselves: one step of expectation
// maximisation, with the configured strength as a prior worth kPriorIntervals of path.
void JointSegment::estimate_drift() {
  const SharedLayout& layout = covariance_.layout;
  const JointProblem problem = problem_for({}, std::exp(shared_.log_scale));
  if (covariance_.shared.rows() != layout.size() || layout.knots != static_cast<int>(shared_.knots.size())) return;
  constexpr double kPriorIntervals = 8.0;
  const double nominal_scale = config_.joint.vo_scale_walk_per_sqrt_m;
  const double nominal_turn = rad_from_deg(config_.joint.vo_rotation_walk_deg_per_sqrt_m);
  double scale_sum = kPriorIntervals * nominal_scale * nominal_scale, scale_count = kPriorIntervals;
  double turn_sum = 3.0 * kPriorIntervals * nominal_turn * nominal_turn, turn_count = 3.0 * kPriorIntervals;
  const Eigen::MatrixXd& P = covariance_.shared;
  const auto second_moment = [&](int k, int offset, double change) {
    const int b = layout.knot(k + 1) + offset;
    double variance = P(b, b);
    if (k > 0) {
      const int a = layout.knot(k) + offset;
      variance += P(a, a) - 2.0 * P(a, b);
    }
    return change * change + std::max(variance, 0.0);
  };
  for (int k = 0; k + 1 < layout.knots; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double length_m = problem.reference_scale_m * problem.intervals[i].length_V;
    const KnotState& a = shared_.knots[i];
    const KnotState& b = shared_.knots[i + 1];
    scale_sum += second_moment(k, 6, b.log_scale_drift - a.log_scale_drift) / length_m;
    scale_count += 1.0;
    for (int j = 0; j < 3; ++j)
      turn_sum += second_moment(k, 3 + j, b.rotation_correction_W[j] - a.rotation_correction_W[j]) / length_m;
    turn_count += 3.0;
  }
  scale_walk_per_sqrt_m_ = std::sqrt(scale_sum / scale_count);
  rotation_walk_rad_per_sqrt_m_ = std::sqrt(turn_sum / turn_count);
}


}  // namespace rfmvo
