#include "estimator/distance_steps.hpp"

#include "base/assert.hpp"

namespace rfmvo {

DistanceSteps::DistanceSteps(std::span<const AntennaArray* const> arrays, const Eigen::VectorXd& measured_m) {
  Eigen::Index elements = 0, usable = 0;
  for (const AntennaArray* array : arrays) {
    elements += array->elements();
    usable += array->usable.count();
  }
  RFMVO_ASSERT(elements > 0 && measured_m.size() == usable);
  lever_m_.resize(elements, 3);
  camera_V_.resize(elements, 3);
  direction_.resize(elements, 3);
  derivative_.resize(elements, 4);
  distance_m_.resize(elements);
  inverse_.resize(elements);
  const Eigen::Index steps = elements - 1;
  step_.resize(steps, 4);
  residual_m_.resize(steps);
  measured_m_ = Eigen::ArrayXd::Zero(steps);
  weight_ = Eigen::ArrayXd::Zero(steps);
  Eigen::Index row = 0, next = 0;
  for (const AntennaArray* array : arrays) {
    lever_m_.middleRows(row, array->elements()) = array->lever_V_m.transpose().array();
    camera_V_.middleRows(row, array->elements()) = array->camera_V.transpose().array();
    for (Eigen::Index i = 0; i < array->steps(); ++i) {
      if (!array->usable(i)) continue;
      measured_m_(row + i) = measured_m(next++);
      weight_(row + i) = 1.0;
    }
    row += array->elements();
  }
}

double DistanceSteps::cost_at(const Eigen::Vector3d& p_X_m, double gamma) {
  for (int axis = 0; axis < 3; ++axis)
    direction_.col(axis) = p_X_m(axis) - lever_m_.col(axis) - gamma * camera_V_.col(axis);
  distance_m_ = (direction_.col(0).square() + direction_.col(1).square() + direction_.col(2).square())
                    .sqrt()
                    .max(kMinTagDistance_m);
  const Eigen::Index steps = weight_.size();
  residual_m_ = weight_ * (measured_m_ - (distance_m_.tail(steps) - distance_m_.head(steps)));
  return residual_m_.square().sum();
}

NormalEquations DistanceSteps::normal_equations() {
  inverse_ = distance_m_.inverse();  // one division instead of three
  for (int axis = 0; axis < 3; ++axis) derivative_.col(axis) = direction_.col(axis) * inverse_;
  derivative_.col(3) = -(derivative_.col(0) * camera_V_.col(0) + derivative_.col(1) * camera_V_.col(1) +
                         derivative_.col(2) * camera_V_.col(2));
  const Eigen::Index steps = weight_.size();
  for (int column = 0; column < 4; ++column)
    step_.col(column) = weight_ * (derivative_.col(column).tail(steps) - derivative_.col(column).head(steps));
  NormalEquations sums;
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b <= a; ++b) sums.matrix(a, b) = sums.matrix(b, a) = (step_.col(a) * step_.col(b)).sum();
    sums.gradient(a) = -(step_.col(a) * residual_m_).sum();  // the residual's derivative is -step
  }
  return sums;
}

}  // namespace rfmvo
