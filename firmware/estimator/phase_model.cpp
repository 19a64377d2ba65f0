#include "estimator/phase_model.hpp"

#include <cmath>

#include "geometry/rigid.hpp"

namespace rfmvo {
namespace {

// A tag cannot sit in the antenna's phase centre; keeps the unit vector defined.
constexpr double kMinDistance_m = 1e-3;

Eigen::Vector3d lever_arm_W(const ReadGeometry& g, const ReadStates& s) {
  return so3_exp(s.rotation_correction_W) *
         (g.R_W_C * (so3_exp(s.time_offset_s * g.angular_velocity_C) * s.lever_arm_C));
}

}  // namespace

Eigen::Vector3d antenna_position(const ReadGeometry& g, const ReadStates& s) {
  return std::exp(s.log_scale) * (g.n_W + s.time_offset_s * g.velocity_W) + s.path_correction_W + lever_arm_W(g, s);
}

double predicted_phase_rad(const ReadGeometry& g, const ReadStates& s) {
  const double distance = std::max((antenna_position(g, s) - s.p_W_X).norm(), kMinDistance_m);
  return g.wavenumber_rad_m * distance + s.tag_offset_rad + s.port_offset_rad +
         g.frequency_term_rad_m * s.electrical_length_m;
}

PredictedPhase predict_phase(const ReadGeometry& g, const ReadStates& s) {
  const double scale = std::exp(s.log_scale);
  const Eigen::Matrix3d R_corrected = so3_exp(s.rotation_correction_W).toRotationMatrix() * g.R_W_C;
  const Eigen::Matrix3d turned = so3_exp(s.time_offset_s * g.angular_velocity_C).toRotationMatrix();
  const Eigen::Vector3d lever_W = R_corrected * (turned * s.lever_arm_C).eval();
  const Eigen::Vector3d moved_W = scale * (g.n_W + s.time_offset_s * g.velocity_W);
  const Eigen::Vector3d ray = moved_W + s.path_correction_W + lever_W - s.p_W_X;
  const double distance = std::max(ray.norm(), kMinDistance_m);
  const Eigen::Vector3d gradient = g.wavenumber_rad_m * ray / distance;  // d phase / d antenna position

  PredictedPhase p;
  p.phase_rad = g.wavenumber_rad_m * distance + s.tag_offset_rad + s.port_offset_rad +
                g.frequency_term_rad_m * s.electrical_length_m;
  p.jacobian.log_scale = gradient.dot(moved_W);
  p.jacobian.time_offset =
      gradient.dot(scale * g.velocity_W + R_corrected * (turned * g.angular_velocity_C.cross(s.lever_arm_C)).eval());
  p.jacobian.electrical_length = g.frequency_term_rad_m;
  p.jacobian.lever_arm = turned.transpose() * (R_corrected.transpose() * gradient).eval();
  p.jacobian.path_correction = gradient;
  p.jacobian.rotation_correction = lever_W.cross(gradient);  // gradient . (theta x lever)
  p.jacobian.tag_position = -gradient;
  return p;
}

}  // namespace rfmvo
