#include "reproduce/scale_windows.hpp"

#include <algorithm>
#include <cmath>

#include "evaluate/alignment.hpp"

namespace rfmvo::reproduce {
namespace {

bool has_pose(const CameraPose& pose) {
  return pose.status == VoStatus::kTracking || pose.status == VoStatus::kDegraded;
}

const MetricPose* pose_at(const std::vector<MetricPose>& path, const CameraPose& pose) {
  const auto found = std::lower_bound(path.begin(), path.end(), pose.time,
                                      [](const MetricPose& p, DeviceTime t) { return p.time < t; });
  return found != path.end() && found->time == pose.time && found->segment == pose.segment ? &*found : nullptr;
}

double spread(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double squares = 0.0;
  for (const auto& p : points) squares += (p - mean).squaredNorm();
  return std::sqrt(squares);
}

}  // namespace

std::vector<ScaleError> window_scale_errors(const std::vector<MetricPose>& path,
                                            const std::vector<CameraPose>& odometry,
                                            const std::vector<simulate::TruePose>& truth) {
  std::vector<ScaleError> errors;
  const CameraPose* start = nullptr;
  for (const CameraPose& pose : odometry) {
    if (!has_pose(pose)) continue;
    if (start == nullptr || start->segment != pose.segment) {
      start = &pose;
      continue;
    }
    if ((pose.time - start->time).seconds() < kWindow_s) continue;
    const MetricPose* a = pose_at(path, *start);
    const MetricPose* b = pose_at(path, pose);
    const auto true_a = evaluate::truth_at(truth, start->time), true_b = evaluate::truth_at(truth, pose.time);
    const double step_V = (pose.T_V_C.p_V_C - start->T_V_C.p_V_C).norm();
    start = &pose;
    if (a == nullptr || b == nullptr || !true_a || !true_b || !(step_V > 0.0)) continue;
    const double true_step_m = (true_b->t - true_a->t).norm();
    if (true_step_m < kMinWindowStep_m) continue;
    const double off_m = std::abs((b->T_W_C.t - a->T_W_C.t).norm() - true_step_m);
    errors.push_back({off_m / step_V, off_m / true_step_m});
  }
  return errors;
}

double true_gamma(const std::vector<CameraPose>& odometry, const std::vector<simulate::TruePose>& truth,
                  DeviceTime first, DeviceTime last) {
  std::vector<Eigen::Vector3d> p_V, p_W;
  auto pose = std::lower_bound(odometry.begin(), odometry.end(), first,
                               [](const CameraPose& p, DeviceTime t) { return p.time < t; });
  for (; pose != odometry.end() && pose->time <= last; ++pose) {
    const auto T_W_C = evaluate::truth_at(truth, pose->time);
    if (!has_pose(*pose) || !T_W_C) continue;
    p_V.push_back(pose->T_V_C.p_V_C);
    p_W.push_back(T_W_C->t);
  }
  if (p_V.size() < 3) return 0.0;
  const double odometry_spread = spread(p_V);
  return odometry_spread > 0.0 ? spread(p_W) / odometry_spread : 0.0;
}

}  // namespace rfmvo::reproduce
