// The frames of a run as a folder that rfmvod plays: images/, times.txt, calib.txt, calibration.toml (antennas too)
// and box.toml, a configuration for it.
#pragma once

#include <string>

#include "base/result.hpp"
#include "estimator/event.hpp"

namespace rfmvo {

class FrameFolder {
 public:
  // Makes the folder. Errors: kUnwritable.
  [[nodiscard]] static Result<FrameFolder> create(const std::string& directory);
  // Takes a Start and Frames that are compressed; other events pass.
  [[nodiscard]] Status write(const Event& event);
  // times.txt comes last: a folder without it is not whole. Error: there was no frame.
  [[nodiscard]] Status close();

 private:
  explicit FrameFolder(std::string directory) : directory_(std::move(directory)) {}
  [[nodiscard]] Status write(const Start& start);
  [[nodiscard]] Status write(const Frame& frame);

  std::string directory_;
  std::string times_;
};

}  // namespace rfmvo
