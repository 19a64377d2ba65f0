#include "estimator/trajectory_recovery.hpp"

#include <algorithm>

#include "base/assert.hpp"

namespace rfmvo {

void TrajectoryRecovery::on(const CameraPose& pose) {
  if (pose.status != VoStatus::kTracking && pose.status != VoStatus::kDegraded) return;
  if (!steps_.empty() && pose.segment == segment_ && pose.time <= steps_.back().pose.time) return;
  if (!steps_.empty() && pose.segment != segment_) {
    const std::vector<MetricPose> old = path();
    if (!old.empty()) T_W_V_ = old.back().T_W_C;
    steps_.clear();
    best_.reset();
  }
  segment_ = pose.segment;
  steps_.push_back({.pose = pose});
}

void TrajectoryRecovery::on(const ScaleCandidate& candidate) {
  if (!best_ || candidate.hdop < best_->hdop) best_ = candidate;
  auto step = std::lower_bound(steps_.begin(), steps_.end(), candidate.first,
                               [](const Step& s, DeviceTime t) { return s.pose.time < t; });
  for (; step != steps_.end(); ++step) {
    if (candidate.hdop < step->hdop) {
      step->hdop = candidate.hdop;
      step->gamma = candidate.gamma;
      step->log_sigma = candidate.log_sigma;
    }
    if (step->pose.time >= candidate.last) break;
  }
}

std::vector<MetricPose> TrajectoryRecovery::path() const {
  std::vector<MetricPose> path;
  const auto covered = std::find_if(steps_.begin(), steps_.end(), [](const Step& s) { return s.gamma > 0.0; });
  if (covered == steps_.end()) return path;
  path.reserve(steps_.size());
  // Steps that no array covers take the scale of the covered step before them (at the start: after).
  const Step* scale = &*covered;
  Eigen::Vector3d p_V_before = Eigen::Vector3d::Zero();  // Eq. (29): X_C[1] = 0
  Eigen::Vector3d p_W_C = T_W_V_.t;
  for (const Step& step : steps_) {
    if (step.gamma > 0.0) scale = &step;
    const Eigen::Vector3d motion_V = step.pose.T_V_C.p_V_C - p_V_before;
    const Eigen::Vector3d motion_W = scale->gamma * (T_W_V_.R * motion_V);
    p_W_C += motion_W;  // Eq. (29)
    p_V_before = step.pose.T_V_C.p_V_C;
    MetricPose pose;
    pose.time = step.pose.time;
    pose.segment = segment_;
    pose.T_W_C = {(T_W_V_.R * step.pose.T_V_C.R_V_C).normalized(), p_W_C};
    // The paper gives none: the scale's error over the way from the start, all steps alike wrong.
    const Eigen::Vector3d way = scale->log_sigma * (p_W_C - T_W_V_.t);
    pose.covariance.topLeftCorner<3, 3>() = way * way.transpose();
    path.push_back(pose);
  }
  return path;
}

Eigen::Vector3d position_at(const std::vector<MetricPose>& path, DeviceTime time) {
  RFMVO_ASSERT(!path.empty());
  const auto after =
      std::lower_bound(path.begin(), path.end(), time, [](const MetricPose& p, DeviceTime t) { return p.time < t; });
  if (after == path.begin()) return path.front().T_W_C.t;
  if (after == path.end()) return path.back().T_W_C.t;
  const auto before = std::prev(after);
  const double f = (time - before->time).seconds() / (after->time - before->time).seconds();
  return before->T_W_C.t + f * (after->T_W_C.t - before->T_W_C.t);
}

}  // namespace rfmvo
