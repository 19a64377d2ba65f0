#include "evaluate/last_estimates.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

namespace rfmvo::evaluate {
namespace {

struct Keeper {
  LastEstimates& last;

  void operator()(const CameraPose& e) const { last.camera_poses.push_back(e); }
  void operator()(const TagEstimate& e) const { last.tags.insert_or_assign(e.epc, e); }
  void operator()(const ScaleEstimate& e) const { last.scales.insert_or_assign(e.segment, e); }
  void operator()(const MetricPose&) const {}
  void operator()(const Trajectory& e) const {
    if (e.poses.empty()) return;
    // A long drive is told in windows: one replaces what was said from its first pose on.
    Trajectory& held = last.trajectories[e.segment];
    const auto before = std::lower_bound(held.poses.begin(), held.poses.end(), e.poses.front().time,
                                         [](const MetricPose& p, DeviceTime t) { return p.time < t; });
    Trajectory whole = e;
    whole.poses.insert(whole.poses.begin(), held.poses.begin(), before);
    held = std::move(whole);
  }
  void operator()(const MapRevision&) const {}
  void operator()(const Health& e) const { last.health = e; }
};

}  // namespace

LastEstimates last_of(const std::vector<Estimate>& estimates) {
  LastEstimates last;
  for (const Estimate& estimate : estimates) std::visit(Keeper{last}, estimate);
  return last;
}

bool is_located(const TagEstimate& tag) {
  return tag.status != TagStatus::kTooFewReads && tag.status != TagStatus::kNoScale && tag.p_W_X_m.allFinite();
}

Eigen::Vector3d sigma_of(const Eigen::Matrix3d& covariance) {
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (covariance(i, i) > 0.0) sigma[i] = std::sqrt(covariance(i, i));
  }
  return sigma;
}

const char* label_of(TagStatus status) {
  switch (status) {
    case TagStatus::kConverged:
      return "CONVERGED";
    case TagStatus::kNoScale:
      return "NO_SCALE";
    case TagStatus::kCircle:
      return "CIRCLE";
    case TagStatus::kMirror:
      return "MIRROR";
    case TagStatus::kWeakGeometry:
      return "WEAK_GEOMETRY";
    case TagStatus::kMoved:
      return "MOVED";
    case TagStatus::kStale:
      return "STALE";
    case TagStatus::kTooFewReads:
      return "TOO_FEW_READS";
  }
  return "UNKNOWN";
}

const char* label_of(VoStatus status) {
  switch (status) {
    case VoStatus::kInitialising:
      return "INITIALISING";
    case VoStatus::kTracking:
      return "TRACKING";
    case VoStatus::kDegraded:
      return "DEGRADED";
    case VoStatus::kLost:
      return "LOST";
  }
  return "UNKNOWN";
}

}  // namespace rfmvo::evaluate
