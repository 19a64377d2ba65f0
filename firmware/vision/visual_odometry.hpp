// Monocular visual odometry: frames in, unscaled camera poses out.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "config/calibration.hpp"
#include "config/config.hpp"
#include "estimator/event.hpp"
#include "vision/lens.hpp"
#include "vision/settled_path.hpp"

namespace rfmvo {

// What the odometry sees and remembers, for people to look at.
struct OdometryView {
  struct Point {
    std::int64_t landmark = 0;
    Eigen::Vector2d px;
    bool located = false;  // has a place in the map
    bool fits = false;     // and agreed with the newest pose
  };
  std::vector<Point> tracks;                 // in the newest image
  std::vector<Eigen::Vector3d> points_V;     // the map's
  std::vector<Eigen::Vector3d> keyframes_V;  // where they were taken
};

class VisualOdometry {
 public:
  VisualOdometry(const VisionConfig& config, const CameraModel& camera);
  ~VisualOdometry();
  VisualOdometry(const VisualOdometry&) = delete;
  VisualOdometry& operator=(const VisualOdometry&) = delete;

  // Deterministic: the same frames give the same bits. A frame whose size differs from the camera
  // model's gives status kLost.
  [[nodiscard]] CameraPose on(const Frame& frame);

  // Poses as the bundle adjustment left them, each a fixed time (SettledPath::kSettleLag) after its frame: those
  // that the last on() settled. A lost segment's come at once.
  [[nodiscard]] std::span<const SettledPose> settled() const;
  // The rest of them; call it after the last frame.
  [[nodiscard]] std::vector<SettledPose> finish();

  [[nodiscard]] OdometryView view() const;

  // What is known of the camera by now.
  [[nodiscard]] const Lens& lens() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo
