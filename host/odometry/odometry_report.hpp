// What `rfmvo vo` tells of a run, as JSON, and its path as a TUM file.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "odometry/odometry_run.hpp"
#include "odometry/path_figures.hpp"

namespace rfmvo::odometry {

// `t tx ty tz qx qy qz qw` of T_V_C, nine digits of the second; a comment line before each new segment.
[[nodiscard]] std::string to_tum(const std::vector<PathPose>& path);

[[nodiscard]] std::vector<PathPose> live_path(const Run& run);     // the poses as they came
[[nodiscard]] std::vector<PathPose> settled_path(const Run& run);  // after bundle adjustment

// Keys: README. `truth` may be empty: figures against it are left out then.
[[nodiscard]] nlohmann::ordered_json report(const Run& run, const std::vector<simulate::TruePose>& truth);

}  // namespace rfmvo::odometry
