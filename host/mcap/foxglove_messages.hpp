// What the box says, as Foxglove's messages. Frames: "map" is W, "camera" is C.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "estimator/estimate.hpp"
#include "estimator/event.hpp"

namespace rfmvo::mcap {

using Json = nlohmann::ordered_json;

enum class LogLevel { kInfo = 2, kWarning = 3, kError = 4 };

[[nodiscard]] Json frame_transform(const MetricPose& pose);
// The tag's 95 % ellipsoid and its name; thinner, those of the other positions that fit. A tag that is not located
// becomes a deletion of what was there.
[[nodiscard]] Json scene_update(const TagEstimate& tag);
[[nodiscard]] Json scene_update(const Trajectory& trajectory);
// Frames that are not compressed become PNG. Null: the frame has no image.
[[nodiscard]] Json compressed_image(const Frame& frame);
[[nodiscard]] Json camera_calibration(const CameraModel& camera, DeviceTime time);
[[nodiscard]] Json log_message(DeviceTime time, LogLevel level, const std::string& name, const std::string& message);

}  // namespace rfmvo::mcap
