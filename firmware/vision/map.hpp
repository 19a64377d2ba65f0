// What the odometry remembers: key frames, and landmarks seen from them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "base/time.hpp"
#include "vision/lens.hpp"
#include "vision/optical_flow.hpp"
#include "vision/view_pose.hpp"

namespace rfmvo {

struct KeyframeObservation {
  std::int64_t keyframe = 0;
  cv::Point2f px;
  Eigen::Vector2d normalised;
};

struct Landmark {
  std::vector<KeyframeObservation> observations;  // oldest first
  bool located = false;
  Eigen::Vector3d p_V = Eigen::Vector3d::Zero();  // meaningful only if located
};

struct Keyframe {
  std::int64_t id = 0;
  DeviceTime time;
  ViewPose T_C_V;
  Pyramid pyramid;
  Twist twist;  // at `time`
};

struct Map {
  std::deque<Keyframe> keyframes;              // ids are consecutive, oldest first
  std::map<std::int64_t, Landmark> landmarks;  // ordered: iteration must not depend on addresses

  [[nodiscard]] const Keyframe* find(std::int64_t id) const {
    if (keyframes.empty() || id < keyframes.front().id || id > keyframes.back().id) return nullptr;
    return &keyframes[static_cast<std::size_t>(id - keyframes.front().id)];
  }
  [[nodiscard]] Keyframe* find(std::int64_t id) {
    return const_cast<Keyframe*>(static_cast<const Map*>(this)->find(id));
  }
};

// A landmark that is being followed from frame to frame.
struct Track {
  std::int64_t landmark = 0;
  cv::Point2f px;
  Eigen::Vector2d normalised;
  int strikes = 0;     // frames in a row with an error above the gate
  bool fresh = false;  // matched back just now: it has to fit at once
};

}  // namespace rfmvo
