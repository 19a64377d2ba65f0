#include "estimator/odometry_path.hpp"

#include <algorithm>
#include <cmath>

namespace rfmvo {
namespace {

// Travel is counted in steps of this length, in units of V (about the median depth of the scene), so
// that the odometry's jitter at standstill adds nothing.
constexpr double kMinStep_V = 0.01;

bool still(const PathPose& a, const PathPose& b) {
  constexpr double kMove_V = 0.002, kTurn_rad = 0.005;
  return a.arc_V == b.arc_V && (a.n_W - b.n_W).norm() < kMove_V && a.R_W_C.angularDistance(b.R_W_C) < kTurn_rad;
}

}  // namespace

void OdometryPath::add(const CameraPose& pose) {
  if (poses_.empty()) {
    pieces_.push_back({{1.0, R_W_C0_ * pose.T_V_C.R_V_C.conjugate(), Eigen::Vector3d::Zero()}, pose.T_V_C.p_V_C});
  } else if (pose.time <= poses_.back().time) {
    return;  // out of order: a path runs forward in time
  }
  const PathPiece& piece = pieces_.back();
  PathPose p;
  p.time = pose.time;
  p.n_W = piece.joint * (pose.T_V_C.p_V_C - piece.p_V_C0);
  p.R_W_C = (piece.joint.R * pose.T_V_C.R_V_C).normalized();
  const double step = (p.n_W - counted_n_W_).norm();
  const double arc = arc_V();
  if (step > kMinStep_V * piece.joint.ratio) {
    p.arc_V = arc + step;
    counted_n_W_ = p.n_W;
  } else {
    p.arc_V = arc;
  }
  // Of a standstill the first and the newest pose tell all.
  if (poses_.size() >= piece.first_pose + 2 && still(poses_[poses_.size() - 2], p))
    poses_.back() = p;
  else
    poses_.push_back(p);
}

void OdometryPath::append(const OdometryPath& later, const PathJoint& joint) {
  const double start_V = arc_V() + kMinStep_V;  // so that a place on the path tells its piece
  for (PathPiece piece : later.pieces_) {
    piece.joint = {joint.ratio * piece.joint.ratio, (joint.R * piece.joint.R).normalized(), joint * piece.joint.n0};
    piece.first_pose += poses_.size();
    piece.arc_V = start_V + joint.ratio * piece.arc_V;
    pieces_.push_back(piece);
  }
  for (PathPose pose : later.poses_) {
    pose.n_W = joint * pose.n_W;
    pose.R_W_C = (joint.R * pose.R_W_C).normalized();
    pose.arc_V = start_V + joint.ratio * pose.arc_V;
    poses_.push_back(pose);
  }
  counted_n_W_ = joint * later.counted_n_W_;
}

std::size_t OdometryPath::piece_of(double arc_V) const {
  std::size_t piece = 0;
  while (piece + 1 < pieces_.size() && pieces_[piece + 1].arc_V <= arc_V) ++piece;
  return piece;
}

double OdometryPath::end_arc_V(std::size_t piece) const {
  return piece + 1 < pieces_.size() ? poses_[pieces_[piece + 1].first_pose - 1].arc_V : arc_V();
}

double OdometryPath::arc_at(DeviceTime time) const {
  const auto after =
      std::lower_bound(poses_.begin(), poses_.end(), time, [](const PathPose& p, DeviceTime t) { return p.time < t; });
  if (after == poses_.begin()) return 0.0;
  if (after == poses_.end()) return arc_V();
  const PathPose& a = *std::prev(after);
  const double f = (time - a.time).seconds() / (after->time - a.time).seconds();
  return a.arc_V + f * (after->arc_V - a.arc_V);
}

ReadGeometry OdometryPath::geometry(const UnscaledPose& T_V_C, const Eigen::Vector3d& velocity_V,
                                    const Eigen::Vector3d& angular_velocity_C, std::size_t piece) const {
  const PathPiece& source = pieces_.at(piece);
  const PathJoint& joint = source.joint;
  ReadGeometry g;
  g.n_W = joint * (T_V_C.p_V_C - source.p_V_C0);
  g.velocity_W = joint.ratio * (joint.R * velocity_V);
  g.R_W_C = (joint.R * T_V_C.R_V_C).toRotationMatrix();
  g.angular_velocity_C = angular_velocity_C;
  return g;
}

std::vector<KnotInterval> OdometryPath::intervals(double spacing_V) const {
  std::vector<KnotInterval> all;
  if (poses_.empty()) return {{Eigen::Vector3d::Zero(), spacing_V}};
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    if (p > 0) all.push_back({.gap = true});
    const std::size_t past_end = p + 1 < pieces_.size() ? pieces_[p + 1].first_pose : poses_.size();
    std::size_t i = pieces_[p].first_pose;
    Eigen::Vector3d start = poses_[i].n_W;
    const int count = knots_of(p, spacing_V) - 1;
    for (int k = 1; k <= count; ++k) {
      while (i + 1 < past_end && poses_[i].arc_V < pieces_[p].arc_V + k * spacing_V) ++i;
      all.push_back({poses_[i].n_W - start, spacing_V});
      start = poses_[i].n_W;
    }
  }
  return all;
}

int OdometryPath::knots_of(std::size_t piece, double spacing_V) const {
  return static_cast<int>(std::floor((end_arc_V(piece) - pieces_[piece].arc_V) / spacing_V)) + 2;
}

KnotPlace OdometryPath::place(double arc_V, double spacing_V) const {
  if (pieces_.empty()) return {};
  const std::size_t piece = piece_of(arc_V);
  int first = 0;
  for (std::size_t p = 0; p < piece; ++p) first += knots_of(p, spacing_V);
  const double s = std::max(0.0, (arc_V - pieces_[piece].arc_V) / spacing_V);
  const double k = std::floor(s);
  return {first + static_cast<int>(k), s - k};
}

}  // namespace rfmvo
