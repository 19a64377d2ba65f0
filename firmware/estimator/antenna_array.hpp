// One antenna array of the paper (section III.A): the last L reads of one tag by one physical
// antenna, with the camera motion between them. What stages 2 to 4 of the paper's estimator share.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>

#include "config/calibration.hpp"
#include "estimator/phase_calibration.hpp"
#include "estimator/sampling_synchronization.hpp"

namespace rfmvo {

// Directions are searched in the frame D of the antenna: z along the boresight, because
// alpha, beta in [0, 180 deg] cover exactly the hemisphere z >= 0 (docs/paper.md).
struct AntennaArray {
  Eigen::Matrix3Xd camera_V;                     // 3 x L: X_C[k,i] minus the array's origin X_C[k,1], units of V
  Eigen::Matrix3Xd lever_V_m;                    // 3 x L: antenna minus camera, axes of V, metres: Eq. (12)
  Eigen::VectorXd phase_step_rad;                // L-1: phi[k,i+1] - phi[k,i], in [-2 pi, 2 pi]: Eq. (2)
  Eigen::VectorXd duration_s;                    // L-1: time between the two reads
  Eigen::Array<bool, Eigen::Dynamic, 1> usable;  // L-1: false = the two phases are not comparable (hop)
  double wavelength_m = 0.0;                     // lambda, mean over the array
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

inline constexpr double kMinTagDistance_m = 1e-3;  // keeps the bearing of a tag on an antenna defined

struct ArrayOptions {
  // Lever arms turn with the camera. Differs from Eq. (11), (12): the paper's constant offset assumes that
  // the cart never turns; 10 deg of yaw on 0.4 m is 2.7 rad of phase.
  bool fix_rotation = false;
  // The frame D turns with the camera as well. Only together with averages on the sphere: the numbers
  // alpha, beta of two arrays can be averaged in one common frame only.
  bool turning_frame = false;
};

// Reads [first, first + count) of one tag on one antenna; p_V_origin: camera position that camera_V counts from.
[[nodiscard]] AntennaArray make_array(const std::deque<SampledRead>& reads, std::size_t first, std::size_t count,
                                      const Eigen::Vector3d& p_V_origin, const AntennaCalibration& antenna,
                                      const PhaseCalibration& phases, const ArrayOptions& options);

}  // namespace rfmvo
