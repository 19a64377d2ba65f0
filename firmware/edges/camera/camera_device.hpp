// A camera as the daemon sees it, whichever driver stands behind it. One thread uses it.
#pragma once

#include <string>
#include <vector>

#include "edges/camera/captured_image.hpp"

namespace rfmvo {

// What a started camera does, where that is not what was asked for: "has no exposure control", ...
struct CameraMode {
  PixelFormat format = PixelFormat::kGrey;
  std::string text;                // driver, device, size, format, rate: for people
  std::vector<std::string> notes;  // what could not be had, one line each
};

class CameraDevice {
 public:
  virtual ~CameraDevice() = default;
  // Opens and begins to take pictures. Errors name the device: absent, busy, another size than configured.
  [[nodiscard]] virtual Result<CameraMode> start(const CameraConfig& config) = 0;
  // Waits for the next picture; nothing if none came within `wait`. Its bytes are valid until the next call of any of
  // these. An error means that the camera is gone or confused: stop(), then start().
  [[nodiscard]] virtual Result<std::optional<CapturedImage>> next(Duration wait) = 0;
  // Exposure and gain of `config` from now on; what could not be had, one line each.
  [[nodiscard]] virtual std::vector<std::string> adjust(const CameraConfig& config) = 0;
  // May be called at any time, also twice.
  virtual void stop() = 0;
};

}  // namespace rfmvo
