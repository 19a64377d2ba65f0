// What a segment's solution says, as the estimator publishes it: in W, with honest covariances and a status.
#pragma once

#include <vector>

#include "config/config.hpp"
#include "estimator/estimate.hpp"
#include "estimator/joint_segment.hpp"

namespace rfmvo {

// camera_rotation_sigma_rad: of the camera's orientation in the frame of the antennas, see calibration.hpp.
[[nodiscard]] TagEstimate describe_tag(const JointSegment& segment, const Epc& epc, const SegmentTag& tag,
                                       DeviceTime now, double camera_rotation_sigma_rad, const JointConfig& config);

// One of each per piece of the path.
[[nodiscard]] std::vector<ScaleEstimate> describe_scales(const JointSegment& segment, DeviceTime now);
[[nodiscard]] std::vector<Trajectory> describe_paths(const JointSegment& segment, DeviceTime now);

}  // namespace rfmvo
