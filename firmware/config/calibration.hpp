// What is bolted where: camera intrinsics, camera on the cart, antennas on the camera.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/camera_model.hpp"
#include "geometry/rigid.hpp"

namespace rfmvo {

struct AntennaCalibration {
  std::uint8_t port = 1;                                   // reader port, 1-based
  Eigen::Vector3d p_C_A_m = Eigen::Vector3d::Zero();       // phase centre in the camera frame (the lever arm)
  Eigen::Vector3d boresight_C = Eigen::Vector3d::UnitZ();  // unit vector of the main beam in the camera frame
  Eigen::Vector3d lever_arm_sigma_m = Eigen::Vector3d::Constant(0.005);  // 1 sigma of p_C_A_m, axis by axis
  // Of cable, reader and antenna together, beyond what the wave travels in the air: turns the phase with the
  // channel's frequency. The default sigma says that nothing is known.
  double electrical_length_m = 0.0, electrical_length_sigma_m = kElectricalLengthUnknown_m;
  static constexpr double kElectricalLengthUnknown_m = 40.0;
};

struct Calibration {
  CameraModel camera;
  Rigid3 T_B_C{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), Eigen::Vector3d::Zero()};  // default: looking forward
  // 1 sigma per axis, common to all lever arms: where the camera's projection centre is in the frame that the
  // antennas were measured in. Antennas are easily measured against each other, a lens's centre is not.
  double camera_sigma_m = 0.0;
  // 1 sigma per axis: how far the camera's axes may be turned against the frame that its path and the antennas
  // are in. Turns every position relative to the camera, whatever the phases say.
  double camera_rotation_sigma_rad = 0.0;
  std::vector<AntennaCalibration> antennas;
};

}  // namespace rfmvo
