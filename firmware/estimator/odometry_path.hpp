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

// n = ratio R n_later + n0: a later segment's displacements in those of an earlier one.
struct PathJoint {
  double ratio = 1.0;  // units of the earlier V per unit of the later
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Eigen::Vector3d n0 = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& n) const { return n0 + ratio * (R * n); }
};

// What one run of odometry brought: displacements of its own unit and axes, joined to those before it. Between two
// pieces the odometry was lost: the interval between the last knot of one and the first of the next is a gap.
struct PathPiece {
  PathJoint joint;  // of its poses in V, less p_V_C0
  Eigen::Vector3d p_V_C0 = Eigen::Vector3d::Zero();
  std::size_t first_pose = 0;
  double arc_V = 0.0;  // where it begins
};

class OdometryPath {
 public:
  // R_W_C0: orientation of the camera at the segment's first pose.
  explicit OdometryPath(const Eigen::Quaterniond& R_W_C0) : R_W_C0_(R_W_C0) {}

  void add(const CameraPose& pose);  // continues the last piece
  // All pieces of a path that came later, behind a gap.
  void append(const OdometryPath& later, const PathJoint& joint);
  [[nodiscard]] const std::vector<PathPiece>& pieces() const { return pieces_; }
  [[nodiscard]] std::size_t piece_of(double arc_V) const;
  [[nodiscard]] double end_arc_V(std::size_t piece) const;
  [[nodiscard]] bool empty() const { return poses_.empty(); }
  [[nodiscard]] const std::vector<PathPose>& poses() const { return poses_; }
  [[nodiscard]] double arc_V() const { return poses_.empty() ? 0.0 : poses_.back().arc_V; }
  [[nodiscard]] double arc_at(DeviceTime time) const;  // interpolated; clamped to the path

  // Camera at a read, in the axes of W: displacement, rotation and velocities. `piece`: whose V the pose is in.
  [[nodiscard]] ReadGeometry geometry(const UnscaledPose& T_V_C, const Eigen::Vector3d& velocity_V,
                                      const Eigen::Vector3d& angular_velocity_C, std::size_t piece = 0) const;

  // Knots every `spacing_V` of travel from the start of each piece, one beyond its end: at least two.
  [[nodiscard]] std::vector<KnotInterval> intervals(double spacing_V) const;
  [[nodiscard]] int knots_of(std::size_t piece, double spacing_V) const;
  [[nodiscard]] KnotPlace place(double arc_V, double spacing_V) const;

 private:
  Eigen::Quaterniond R_W_C0_;
  std::vector<PathPiece> pieces_;
  Eigen::Vector3d counted_n_W_ = Eigen::Vector3d::Zero();  // where travel was last counted
  std::vector<PathPose> poses_;
};

}  // namespace rfmvo
