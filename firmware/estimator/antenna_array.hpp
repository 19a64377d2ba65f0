// One antenna array of the paper (section III.A): the last L reads of one tag by one physical
// antenna, with the camera motion between them. What stages 2 to 4 of the paper's estimator share.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/time.hpp"
#include "geometry/rigid.hpp"

namespace rfmvo {

// Directions are searched in the frame D of the antenna: z along the boresight, because
// alpha, beta in [0, 180 deg] cover exactly the hemisphere z >= 0 (docs/paper.md).
struct AntennaArray {
  Eigen::Matrix3Xd camera_V;        // 3 x L: X_C[k,i] - X_C[k,1], units of V
  Eigen::Matrix3Xd lever_V_m;       // 3 x L: antenna minus camera, axes of V, metres: Eq. (12)
  Eigen::VectorXd phase_step_rad;   // L-1: phi[k,i+1] - phi[k,i], in [-2 pi, 2 pi]: Eq. (2)
  Eigen::VectorXd duration_s;       // L-1: time between the two reads
  Eigen::Array<bool, Eigen::Dynamic, 1> usable;  // L-1: false = the two phases are not comparable (hop)
  double wavelength_m = 0.0;        // lambda, mean over the array
  Eigen::Quaterniond R_V_D = Eigen::Quaterniond::Identity();

  [[nodiscard]] Eigen::Index elements() const { return camera_V.cols(); }
  [[nodiscard]] Eigen::Index steps() const { return camera_V.cols() - 1; }

  // Eq. (11), (12), (19): antenna position relative to the camera at the array's first read, axes of
  // V, metres, for a scale of gamma metres per unit of V.
  [[nodiscard]] Eigen::Vector3d position_m(Eigen::Index i, double gamma) const {
    return lever_V_m.col(i) + gamma * camera_V.col(i);
  }
  // Length of X_C[k,i+1] - X_C[k,i], units of V.
  [[nodiscard]] double camera_step(Eigen::Index i) const { return (camera_V.col(i + 1) - camera_V.col(i)).norm(); }
};

}  // namespace rfmvo
