#include "estimator/odometry_path.hpp"

#include <algorithm>
#include <cmath>

namespace rfmvo {
namespace {

// Travel is counted in steps of this length, in units of V (about the median depth of the scene), so
// that the odometry's jitter at standstill adds nothing.
constexpr double kMinStep_V = 0.01;

}  // namespace

void OdometryPath::add(const CameraPose& pose) {
  if (poses_.empty()) {
    R_W_V_ = R_W_C0_ * pose.T_V_C.R_V_C.conjugate();
    p_V_C0_ = pose.T_V_C.p_V_C;
  } else if (pose.time <= poses_.back().time) {
    return;  // out of order: a path runs forward in time
  }
  PathPose p;
  p.time = pose.time;
  p.n_W = R_W_V_ * (pose.T_V_C.p_V_C - p_V_C0_);
  p.R_W_C = (R_W_V_ * pose.T_V_C.R_V_C).normalized();
  const double step = (p.n_W - counted_n_W_).norm();
  const double arc = arc_V();
  if (step > kMinStep_V) {
    p.arc_V = arc + step;
    counted_n_W_ = p.n_W;
  } else {
    p.arc_V = arc;
  }
  poses_.push_back(p);
}

double OdometryPath::arc_at(DeviceTime time) const {
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), time,
                                      [](const PathPose& p, DeviceTime t) { return p.time < t; });
  if (after == poses_.begin()) return 0.0;
  if (after == poses_.end()) return arc_V();
  const PathPose& a = *std::prev(after);
  const double f = (time - a.time).seconds() / (after->time - a.time).seconds();
  return a.arc_V + f * (after->arc_V - a.arc_V);
}

ReadGeometry OdometryPath::geometry(const UnscaledPose& T_V_C, const Eigen::Vector3d& velocity_V,
                                    const Eigen::Vector3d& angular_velocity_C) const {
  ReadGeometry g;
  g.n_W = R_W_V_ * (T_V_C.p_V_C - p_V_C0_);
  g.velocity_W = R_W_V_ * velocity_V;
  g.R_W_C = (R_W_V_ * T_V_C.R_V_C).toRotationMatrix();
  g.angular_velocity_C = angular_velocity_C;
  return g;
}

std::vector<KnotInterval> OdometryPath::intervals(double spacing_V) const {
  std::vector<KnotInterval> all;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  std::size_t i = 0;
  const auto count = static_cast<std::size_t>(std::floor(arc_V() / spacing_V)) + 1;
  for (std::size_t k = 1; k <= count; ++k) {
    const double arc = static_cast<double>(k) * spacing_V;
    while (i + 1 < poses_.size() && poses_[i].arc_V < arc) ++i;
    const Eigen::Vector3d end = poses_.empty() ? start : poses_[i].n_W;
    all.push_back({end - start, spacing_V});
    start = end;
  }
  return all;
}

KnotPlace OdometryPath::place(double arc_V, double spacing_V) const {
  const double s = std::max(0.0, arc_V / spacing_V);
  const double k = std::floor(s);
  return {static_cast<int>(k), s - k};
}

}  // namespace rfmvo
