// Stage 4, accuracy estimation (paper section V): the horizontal dilution of precision of a tag
// position, Eq. (23)-(28). Geometry only: no noise level, no height, no phase offset, no scale.
#pragma once

#include <Eigen/Core>
#include <span>

namespace rfmvo {

struct Hdop {
  bool defined = false;  // false: rank-deficient (fewer than two horizontal bearings), infinite dilution
  double value = 0.0;    // Eq. (28): metres of horizontal error per metre of distance error; 0 if undefined
  Eigen::Matrix2d Q = Eigen::Matrix2d::Zero();  // Eq. (27), x and y of W
};

// p_W_A_m: all M x L antenna positions, p_W_X_m: the tag; both in W (z up), metres.
[[nodiscard]] Hdop horizontal_dilution(std::span<const Eigen::Vector3d> p_W_A_m, const Eigen::Vector3d& p_W_X_m);

}  // namespace rfmvo
