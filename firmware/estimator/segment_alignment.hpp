// Two maps of the same tags laid over each other: how an odometry segment continues the one before it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/rigid.hpp"

namespace rfmvo {

// Where a tag may be, and how likely, in either map.
struct PlaceShare {
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
  double share = 1.0;
};
struct SharedTag {
  std::vector<PlaceShare> first, second;
};

// The camera's pose when the second map begins, as far as the first one tells: it moved on for a moment.
struct ExpectedStart {
  Rigid3 T_first_C, T_second_C;
  double position_sigma_m = 0.3, rotation_sigma_rad = 0.2;
};

struct Alignment {
  Rigid3 T_first_second;
  double tags = 0.0;        // that agree, in probability
  double residual_m = 0.0;  // RMS over these
};

// The T_first_second that maximises the expected ln likelihood over which place of a tag is its true one (expectation
// maximisation), from wide tolerances to narrow ones. Nothing: fewer than three tags agree within `tolerance_m`.
[[nodiscard]] std::optional<Alignment> align_maps(const std::vector<SharedTag>& tags, const ExpectedStart& start,
                                                  double tolerance_m);

}  // namespace rfmvo
