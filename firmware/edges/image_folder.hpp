// A recorded image sequence as a camera: DIR/times.txt with lines "t filename" (seconds), the images,
// and DIR/calib.txt with "fx fy cx cy width height model d0 d1 ..." (px; model: none, radtan or
// equidistant); without a calib.txt, camchain.yaml, camera_info.yaml, calibration.yaml, camera.yaml or calib.yaml.
// Lines that begin with # are comments.
#pragma once

#include <memory>
#include <string>

#include "config/calibration.hpp"
#include "edges/event_io.hpp"

namespace rfmvo {

// The one line of a calib.txt. Errors name file and line.
[[nodiscard]] Result<CameraModel> read_camera_line(const std::string& path);

class ImageFolder : public EventSource {
 public:
  // Reads both text files; images are read one by one. Errors name file and line.
  [[nodiscard]] static Result<std::unique_ptr<ImageFolder>> open(const std::string& directory);
  ~ImageFolder() override;

  [[nodiscard]] const CameraModel& camera() const;
  // A Start with the default configuration and this camera at the time of the first image, then a
  // Frame per image. A missing image or one of another size than calib.txt says is an error naming it.
  [[nodiscard]] Result<std::optional<Event>> next() override;

 private:
  struct Impl;
  explicit ImageFolder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo
