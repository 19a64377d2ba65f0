// The camera that the configuration names.
#pragma once

#include <memory>
#include <string_view>

#include "edges/camera/camera_device.hpp"

namespace rfmvo {

// camera.source names hardware: "v4l2:DEVICE" or "libcamera:ID".
[[nodiscard]] bool is_camera(std::string_view source);

// Does not open the device yet: a camera that is absent is no error. Errors: libcamera, in a program built without it.
[[nodiscard]] Result<std::unique_ptr<CameraDevice>> make_camera(const CameraConfig& config);

}  // namespace rfmvo
