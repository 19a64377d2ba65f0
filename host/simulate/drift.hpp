// Visual odometry without images: the true camera motion, drifted as a monocular odometry drifts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "estimator/event.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::simulate {

// X_V = (1/gamma) * integral of (1 + e) R(theta) dX, + n: e and theta are random walks in the distance
// travelled, n is white. Measured against real monocular odometry (fr2_desk: 0.10 % rms over 6 m).
struct DriftClass {
  std::string name;
  double white_m = 0.0;                       // n, per axis and pose
  double scale_walk_per_sqrt_m = 0.0;         // e
  double rotation_walk_rad_per_sqrt_m = 0.0;  // theta, each of three axes
  double rotation_bias_rad_per_m = 0.0;  // theta about the camera's vertical, either sign: what a wrong distortion does
};

[[nodiscard]] std::optional<DriftClass> find_drift_class(const std::string& name);

struct DriftedPoses {
  std::vector<CameraPose> poses;
  double scale_m_per_unit = 1.0;  // gamma
};

// V is the camera frame of the first pose. Each part of an interrupted path has its own random numbers.
[[nodiscard]] DriftedPoses drift(const std::vector<TruePose>& truth, const DriftClass& drift_class, std::uint64_t seed,
                                 std::uint64_t part = 0);

}  // namespace rfmvo::simulate
