// Trajectory recovery (paper section V): the camera path in metres, each step with the scale of the
// array of least HDOP that covers it, Eq. (29).
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "estimator/estimate.hpp"
#include "estimator/event.hpp"
#include "geometry/rigid.hpp"

namespace rfmvo {

// The scale that one antenna array of one tag gives for the time it spans.
struct ScaleCandidate {
  DeviceTime first, last;
  double gamma = 0.0;  // metres per unit of V
  double log_sigma = 0.0;
  double hdop = 0.0;
};

class TrajectoryRecovery {
 public:
  explicit TrajectoryRecovery(const Rigid3& T_B_C) : T_W_V_(T_B_C) {}

  // The path begins anew at the last recovered pose when the segment changes: the motion in between is
  // unknown to the paper and taken as none. Poses come in time order.
  void on(const CameraPose& pose);
  void on(const ScaleCandidate& candidate);  // of the current segment

  [[nodiscard]] std::uint32_t segment() const { return segment_; }
  // The candidate of least HDOP in the current segment.
  [[nodiscard]] const std::optional<ScaleCandidate>& best() const { return best_; }

  // Rotation from V of the current segment to W.
  [[nodiscard]] const Eigen::Quaterniond& R_W_V() const { return T_W_V_.R; }
  // Recovered path of the current segment; empty before the first candidate.
  [[nodiscard]] std::vector<MetricPose> path() const;

 private:
  struct Step {
    CameraPose pose;  // at the end of the step
    double hdop = std::numeric_limits<double>::infinity();
    double gamma = 0.0;
    double log_sigma = 0.0;
  };

  Rigid3 T_W_V_;  // where the segment begins
  std::uint32_t segment_ = 0;
  std::vector<Step> steps_;
  std::optional<ScaleCandidate> best_;
};

// Position on a recovered path, linear between its poses; the path must not be empty.
[[nodiscard]] Eigen::Vector3d position_at(const std::vector<MetricPose>& path, DeviceTime time);

}  // namespace rfmvo
