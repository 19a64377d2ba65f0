// Scale of a path against the truth, piece by piece.
#pragma once

#include <vector>

#include "estimator/estimate.hpp"
#include "reproduce/results.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::reproduce {

// Eq. (31) over a second instead of one frame, because the ratio of one frame's step is the odometry's noise:
// gamma = |recovered step| / |step in V|, gamma_true = |true step| / |step in V|. One error per whole window within one
// segment in which the camera truly moved kMinWindowStep_m.
inline constexpr double kWindow_s = 1.0, kMinWindowStep_m = 0.05;
[[nodiscard]] std::vector<ScaleError> window_scale_errors(const std::vector<MetricPose>& path,
                                                          const std::vector<CameraPose>& odometry,
                                                          const std::vector<simulate::TruePose>& truth);

// Metres per unit of V between two times: ratio of the spreads about the mean of both paths. 0: no motion, or
// not three poses.
[[nodiscard]] double true_gamma(const std::vector<CameraPose>& odometry, const std::vector<simulate::TruePose>& truth,
                                DeviceTime first, DeviceTime last);

}  // namespace rfmvo::reproduce
