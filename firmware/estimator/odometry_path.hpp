// The odometry's poses of one segment in the axes of W, still without scale, and the knots at which
// the path is corrected.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "base/time.hpp"
#include "estimator/event.hpp"
#include "estimator/joint_problem.hpp"
#include "geometry/rigid.hpp"

namespace rfmvo {

struct PathPose {
  DeviceTime time;
  Eigen::Vector3d n_W = Eigen::Vector3d::Zero();  // unscaled displacement of the camera since the first pose
  Eigen::Quaterniond R_W_C = Eigen::Quaterniond::Identity();
  double arc_V = 0.0;  // travel since the first pose; jitter below a threshold does not count
};

struct KnotPlace {
  int knot = 0;
  double fraction = 0.0;
};

class OdometryPath {
 public:
  // R_W_C0: orientation of the camera at the segment's first pose.
  explicit OdometryPath(const Eigen::Quaterniond& R_W_C0) : R_W_C0_(R_W_C0) {}

  void add(const CameraPose& pose);
  [[nodiscard]] bool empty() const { return poses_.empty(); }
  [[nodiscard]] const std::vector<PathPose>& poses() const { return poses_; }
  [[nodiscard]] double arc_V() const { return poses_.empty() ? 0.0 : poses_.back().arc_V; }
  [[nodiscard]] double arc_at(DeviceTime time) const;  // interpolated; clamped to the path

  // Camera at a read, in the axes of W: displacement, rotation and velocities.
  [[nodiscard]] ReadGeometry geometry(const UnscaledPose& T_V_C, const Eigen::Vector3d& velocity_V,
                                      const Eigen::Vector3d& angular_velocity_C) const;

  // Knots every `spacing_V` of travel from the start, one beyond the end: at least two.
  [[nodiscard]] std::vector<KnotInterval> intervals(double spacing_V) const;
  [[nodiscard]] KnotPlace place(double arc_V, double spacing_V) const;

 private:
  Eigen::Quaterniond R_W_C0_;
  Eigen::Quaterniond R_W_V_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_V_C0_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d counted_n_W_ = Eigen::Vector3d::Zero();  // where travel was last counted
  std::vector<PathPose> poses_;
};

}  // namespace rfmvo
