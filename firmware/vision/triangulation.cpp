#include "vision/triangulation.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "vision/reprojection.hpp"

namespace rfmvo {
namespace {

Eigen::Vector3d direction_V(const SightLine& line) {
  return (line.T_C_V.R_C_V.conjugate() * line.measured.homogeneous()).normalized();
}

// Middle of the shortest segment between two lines; the lines are not parallel.
Eigen::Vector3d midpoint(const SightLine& a, const SightLine& b) {
  const Eigen::Vector3d p = a.T_C_V.centre(), q = b.T_C_V.centre();
  const Eigen::Vector3d d = direction_V(a), e = direction_V(b), baseline = q - p;
  const double c = d.dot(e), sine2 = 1.0 - c * c;
  const double s = (baseline.dot(d) - c * baseline.dot(e)) / sine2;
  const double t = (c * baseline.dot(d) - baseline.dot(e)) / sine2;
  return 0.5 * (p + s * d + q + t * e);
}

bool refine(std::span<const SightLine> lines, double focal_px, Eigen::Vector3d& p_V) {
  constexpr int kIterations = 3;  // the start is within a few percent; Gauss-Newton squares the error
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const SightLine& line : lines) {
      const Reprojection r = reproject(line.T_C_V * p_V, line.measured, focal_px * line.scale);
      if (!r.in_front) return false;
      const Eigen::Matrix<double, 2, 3> J = r.d_camera_point * line.T_C_V.R_C_V.toRotationMatrix();
      H.noalias() += J.transpose() * J;
      b.noalias() -= J.transpose() * r.error_px;
    }
    p_V += H.ldlt().solve(b);
  }
  return p_V.allFinite();
}

}  // namespace

double parallax(const SightLine& a, const SightLine& b) {
  const Eigen::Vector3d d = direction_V(a), e = direction_V(b);
  return std::atan2(d.cross(e).norm(), d.dot(e));
}

std::optional<Eigen::Vector3d> triangulate(std::span<const SightLine> lines, double min_parallax_rad, double focal_px,
                                           double gate_px) {
  if (lines.size() < 2 || parallax(lines.front(), lines.back()) < min_parallax_rad) return std::nullopt;
  Eigen::Vector3d p_V = midpoint(lines.front(), lines.back());
  if (!refine(lines, focal_px, p_V)) return std::nullopt;
  for (const SightLine& line : lines) {
    const Reprojection r = reproject(line.T_C_V * p_V, line.measured, focal_px * line.scale);
    if (!r.in_front || r.error_px.norm() > gate_px) return std::nullopt;
  }
  return p_V;
}

}  // namespace rfmvo
