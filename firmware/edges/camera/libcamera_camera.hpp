// A camera behind libcamera: CSI cameras of a Raspberry Pi, and any other that it knows. One source for 0.0.3 (Debian
// 12) and 0.4 and newer. Only built where libcamera is (RFMVO_WITH_LIBCAMERA).
#pragma once

#include <memory>

#include "edges/camera/camera_device.hpp"

namespace rfmvo {

class LibcameraCamera : public CameraDevice {
 public:
  // id: as libcamera lists it; empty: the first one.
  explicit LibcameraCamera(std::string id);
  ~LibcameraCamera() override;

  [[nodiscard]] Result<CameraMode> start(const CameraConfig& config) override;
  [[nodiscard]] Result<std::optional<CapturedImage>> next(Duration wait) override;
  [[nodiscard]] std::vector<std::string> adjust(const CameraConfig& config) override;
  void stop() override;

 private:
  struct Session;  // from start() to stop()
  std::string id_;
  std::unique_ptr<Session> session_;
};

}  // namespace rfmvo
