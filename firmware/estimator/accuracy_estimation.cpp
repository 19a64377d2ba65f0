#include "estimator/accuracy_estimation.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace rfmvo {
namespace {

// Smaller over larger eigenvalue of G'G: the mean squared spread of the bearings, here 0.06 deg.
// Below it the inverse is rounding, and the dilution is infinite for every purpose.
constexpr double kMinCondition = 1e-6;
constexpr double kMinDistance_m = 1e-6;  // a tag on an antenna has no bearing from it

}  // namespace

Hdop horizontal_dilution(std::span<const Eigen::Vector3d> p_W_A_m, const Eigen::Vector3d& p_W_X_m) {
  Eigen::Matrix2d GtG = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector3d& p_W_A : p_W_A_m) {
    const Eigen::Vector3d d = p_W_X_m - p_W_A;
    const double distance = d.norm();
    if (!(distance > kMinDistance_m) || !std::isfinite(distance)) continue;
    const Eigen::Vector2d row = d.head<2>() / distance;  // Eq. (23), (26): d(distance)/dx, d/dy
    GtG += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(GtG);
  const Eigen::Vector2d values = eigen.eigenvalues();  // ascending
  if (!(values(1) > 0.0) || !(values(0) > kMinCondition * values(1))) return {};
  Hdop hdop;
  hdop.defined = true;
  hdop.Q = eigen.eigenvectors() * values.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();  // Eq. (27)
  hdop.value = std::sqrt(hdop.Q.trace());                                                                 // Eq. (28)
  return hdop;
}

}  // namespace rfmvo
