#include "estimator/principal_axes.hpp"

#include <Eigen/Eigenvalues>

namespace rfmvo {

PrincipalAxes principal_axes(const std::vector<Eigen::Vector3d>& places) {
  PrincipalAxes result;
  const double share = 1.0 / static_cast<double>(places.size());
  for (const Eigen::Vector3d& p : places) result.centre += share * p;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : places) spread += share * (p - result.centre) * (p - result.centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);  // rising
  result.axes = solver.eigenvectors();
  result.sigma_m = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return result;
}

}  // namespace rfmvo
