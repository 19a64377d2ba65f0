// Eq. (18), (19) for Levenberg-Marquardt: the sums over all steps of all antennas at once, in arrays that the
// compiler's vector units run. The residuals one by one: distance_residuals (joint_optimization.hpp).
#pragma once

#include <Eigen/Core>
#include <span>

#include "estimator/antenna_array.hpp"

namespace rfmvo {

// J'J and J'r of r = Delta d_A - Delta d_C over (X_T, gamma).
struct NormalEquations {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
};

class DistanceSteps {
 public:
  // measured_m: Delta d_A of the usable steps, antenna by antenna. The arrays may go afterwards.
  DistanceSteps(std::span<const AntennaArray* const> arrays, const Eigen::VectorXd& measured_m);

  // |r|^2 alone, much cheaper; a trial that does not lower it needs no more.
  [[nodiscard]] double cost_at(const Eigen::Vector3d& p_X_m, double gamma);
  // Where cost_at() was asked for last.
  [[nodiscard]] NormalEquations normal_equations();

 private:
  using Rows3 = Eigen::Array<double, Eigen::Dynamic, 3>;
  using Rows4 = Eigen::Array<double, Eigen::Dynamic, 4>;
  // One row per element; row i + 1 minus row i is step i. The last row of an antenna and steps that cannot be compared
  // have weight 0.
  Rows3 lever_m_, camera_V_;
  Eigen::ArrayXd measured_m_, weight_;
  Rows3 direction_;          // scratch
  Rows4 derivative_, step_;  // scratch
  Eigen::ArrayXd distance_m_, inverse_, residual_m_;
};

}  // namespace rfmvo
