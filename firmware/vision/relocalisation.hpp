// Where the camera is after a gap, from the map alone: descriptors instead of a prediction.
#pragma once

#include <optional>

#include "vision/lens.hpp"
#include "vision/map.hpp"
#include "vision/motion_solver.hpp"

namespace rfmvo {

// A guess at the pose of this picture: landmarks of the newest key frames whose upright ORB descriptors match corners
// of it (near where the predicted pose has them; if that leads to nothing, anywhere), P3P inside RANSAC. No value: too
// few of the matches agree. Repeated texture may agree on a wrong place: whoever believes the guess must look for the
// map's patches there.
[[nodiscard]] std::optional<ViewPose> guess_pose(const Map& map, const Lens& lens, const cv::Mat& grey,
                                                 const ViewPose& predicted, const MotionOptions& options);

}  // namespace rfmvo
