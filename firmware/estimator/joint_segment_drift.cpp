// JointSegment: how strongly the odometry drifts.
#include <array>

#include "base/units.hpp"
#include "estimator/joint_segment.hpp"

namespace rfmvo {
namespace {

// Odometry is better or worse than configured by one factor: from one class of the drift model to the next
// its scale wanders three times as much, its heading twice.
constexpr std::array<double, 5> kFactors{1.0, 2.0, 4.0, 8.0, 16.0};
constexpr double kTurnExponent = 0.63;  // 3^0.63 = 2

}  // namespace

void JointSegment::set_drift(double factor) {
  drift_factor_ = factor;
  scale_walk_per_sqrt_m_ = factor * config_.joint.vo_scale_walk_per_sqrt_m;
  rotation_walk_rad_per_sqrt_m_ =
      std::pow(factor, kTurnExponent) * rad_from_deg(config_.joint.vo_rotation_walk_deg_per_sqrt_m);
  position_walk_m_per_sqrt_m_ = factor * config_.joint.vo_position_walk_m_per_sqrt_m;
}

// The factor that the reads of the joined tags favour, up to one step from where it stands.
void JointSegment::estimate_drift() {
  const JointSegment before = *this;
  double best = 0.0;
  std::optional<JointSegment> chosen;
  for (const double factor : kFactors) {
    if (factor > 2.1 * before.drift_factor_ || factor < before.drift_factor_ / 2.1) continue;
    JointSegment trial = before;
    trial.set_drift(factor);
    if (factor != before.drift_factor_) trial.refine(false);
    const double likelihood = trial.total_evidence();
    if (!chosen || likelihood > best) {
      best = likelihood;
      chosen = trial;
    }
  }
  *this = *chosen;
}

}  // namespace rfmvo
