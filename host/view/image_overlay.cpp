#include "view/image_overlay.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace rfmvo::view {
namespace {

constexpr double kChi2_95_2dof = 5.991464547107979;  // 95 % of chi-square, 2 degrees of freedom
constexpr double kNearest_m = 0.1;

}  // namespace

std::optional<ImageEllipse> in_picture(const CameraModel& camera, const Rigid3& T_W_C, const Eigen::Vector3d& p_W_X_m,
                                       const Eigen::Matrix3d& covariance_W_m2) {
  const Eigen::Vector3d p = T_W_C.inverse() * p_W_X_m;
  if (!(p.z() > kNearest_m)) return std::nullopt;
  const Eigen::Vector2d normalised = p.head<2>() / p.z();
  ImageEllipse ellipse;
  ellipse.centre_px = project(camera, normalised);
  ellipse.distance_m = p.z();
  const double margin = camera.width_px;
  if (!ellipse.centre_px.allFinite() || ellipse.centre_px.x() < -margin || ellipse.centre_px.y() < -margin ||
      ellipse.centre_px.x() > camera.width_px + margin || ellipse.centre_px.y() > camera.height_px + margin)
    return std::nullopt;

  Eigen::Matrix<double, 2, 3> d_normalised;
  d_normalised << 1.0, 0.0, -normalised.x(), 0.0, 1.0, -normalised.y();
  const Eigen::Matrix2d focal = Eigen::Vector2d(camera.fx_px, camera.fy_px).asDiagonal();
  const Eigen::Matrix<double, 2, 3> J = focal * distort_jacobian(camera, normalised) * d_normalised / p.z();
  const Eigen::Matrix3d R_C_W = T_W_C.R.conjugate().toRotationMatrix();
  const Eigen::Matrix2d covariance = J * R_C_W * covariance_W_m2 * R_C_W.transpose() * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance);
  ellipse.minor_px = std::sqrt(kChi2_95_2dof * std::max(solver.eigenvalues()[0], 0.0));
  ellipse.major_px = std::sqrt(kChi2_95_2dof * std::max(solver.eigenvalues()[1], 0.0));
  ellipse.angle_rad = std::atan2(solver.eigenvectors()(1, 1), solver.eigenvectors()(0, 1));
  return ellipse;
}

}  // namespace rfmvo::view
