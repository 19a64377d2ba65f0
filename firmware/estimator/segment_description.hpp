// What a segment's solution says, as the estimator publishes it: in W, with honest covariances and a status.
#pragma once

#include <map>
#include <vector>

#include "config/config.hpp"
#include "estimator/estimate.hpp"
#include "estimator/joint_segment.hpp"

namespace rfmvo {

struct SegmentsDescription {
  std::map<Epc, TagEstimate> tags;  // where several segments saw a tag: the one that says more
  std::vector<ScaleEstimate> scales;
  std::vector<Trajectory> paths;
};

// camera_rotation_sigma_rad: of the camera's orientation in the frame of the antennas, see calibration.hpp.
[[nodiscard]] SegmentsDescription describe_segments(const std::vector<JointSegment>& segments, DeviceTime now,
                                                    double camera_rotation_sigma_rad, const JointConfig& config);

}  // namespace rfmvo
