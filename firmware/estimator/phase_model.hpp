// The measurement model of the joint estimator: the phase of a spherical wave from the antenna's true
// position to the tag, with the sum of offsets of DESIGN: tag part + port part + port electrical
// length x frequency. Angles in rad, lengths in m. docs/estimator.md, section 1.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rfmvo {

// What is known about one read before anything is estimated.
struct ReadGeometry {
  Eigen::Vector3d n_W = Eigen::Vector3d::Zero();  // unscaled camera displacement since the segment's start, axes of W
  Eigen::Vector3d velocity_W = Eigen::Vector3d::Zero();          // d n_W / dt, units of V per second
  Eigen::Matrix3d R_W_C = Eigen::Matrix3d::Identity();           // odometry's rotation
  Eigen::Vector3d angular_velocity_C = Eigen::Vector3d::Zero();  // rad/s
  double wavenumber_rad_m = 0.0;                                 // 4 pi f / c: there and back
  double frequency_term_rad_m = 0.0;  // 4 pi (f - f_ref) / c: phase per metre of electrical length
};

// The states that one read depends on, at the read's time.
struct ReadStates {
  double log_scale = 0.0;      // ln(metres per unit of V)
  double time_offset_s = 0.0;  // camera time = read time + offset
  double port_offset_rad = 0.0;
  double electrical_length_m = 0.0;
  Eigen::Vector3d lever_arm_C = Eigen::Vector3d::Zero();
  Eigen::Vector3d path_correction_W = Eigen::Vector3d::Zero();      // d, m
  Eigen::Vector3d rotation_correction_W = Eigen::Vector3d::Zero();  // theta, rad
  Eigen::Vector3d p_W_X = Eigen::Vector3d::Zero();
  double tag_offset_rad = 0.0;
};

struct PhaseJacobian {
  double log_scale = 0.0;
  double time_offset = 0.0;
  double electrical_length = 0.0;  // port and tag offset: 1
  Eigen::Vector3d lever_arm = Eigen::Vector3d::Zero();
  Eigen::Vector3d path_correction = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_correction = Eigen::Vector3d::Zero();
  Eigen::Vector3d tag_position = Eigen::Vector3d::Zero();
};

struct PredictedPhase {
  double phase_rad = 0.0;  // not wrapped
  PhaseJacobian jacobian;  // d phase / d state; rotation correction: left perturbation exp(theta) R, exact at theta = 0
};

// Antenna position: p_W_A = e^log_scale (n + v tau) + d + exp(theta) R_W_C exp(omega tau) l.
[[nodiscard]] Eigen::Vector3d antenna_position(const ReadGeometry& geometry, const ReadStates& states);
[[nodiscard]] double predicted_phase_rad(const ReadGeometry& geometry, const ReadStates& states);  // not wrapped
[[nodiscard]] PredictedPhase predict_phase(const ReadGeometry& geometry, const ReadStates& states);

}  // namespace rfmvo
