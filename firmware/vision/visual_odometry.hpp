// Monocular visual odometry: frames in, unscaled camera poses out.
#pragma once

#include <memory>

#include "config/calibration.hpp"
#include "config/config.hpp"
#include "estimator/event.hpp"
#include "vision/lens.hpp"

namespace rfmvo {

class VisualOdometry {
 public:
  VisualOdometry(const VisionConfig& config, const CameraModel& camera);
  ~VisualOdometry();
  VisualOdometry(const VisualOdometry&) = delete;
  VisualOdometry& operator=(const VisualOdometry&) = delete;

  // Deterministic: the same frames give the same bits. A frame whose size differs from the camera
  // model's gives status kLost.
  [[nodiscard]] CameraPose on(const Frame& frame);

  // What is known of the camera by now.
  [[nodiscard]] const Lens& lens() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo
