// The message types that Foxglove draws, as JSON Schemas: names and fields as docs.foxglove.dev/docs/sdk/schemas lists
// them. Only the fields that are written here.
#pragma once

#include <string>

namespace rfmvo::mcap {

[[nodiscard]] std::string frame_transform_schema();     // foxglove.FrameTransform
[[nodiscard]] std::string scene_update_schema();        // foxglove.SceneUpdate
[[nodiscard]] std::string compressed_image_schema();    // foxglove.CompressedImage
[[nodiscard]] std::string camera_calibration_schema();  // foxglove.CameraCalibration
[[nodiscard]] std::string log_schema();                 // foxglove.Log

}  // namespace rfmvo::mcap
