// The joint estimator (docs/estimator.md): one least-squares problem over all tags, all antennas and
// the whole path: spherical waves, ONE scale per segment, corrections to the odometry, shared port
// offsets, phase error correlated along the path. Started from the near-field power spectrum.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "config/calibration.hpp"
#include "config/config.hpp"
#include "estimator/estimate.hpp"
#include "estimator/event.hpp"
#include "estimator/sampling_synchronization.hpp"
#include "estimator/worker.hpp"

namespace rfmvo {

// A window of the path is solved as one problem up to this travel, or this many poses (ten minutes at 30 frames/s).
// From the half on, a second window fills beside it and takes over: what passes the antennas within half a window is
// seen whole by one of them. Time and memory are those of two windows, however long the drive.
struct Window {
  double length_m = 24.0;
  std::size_t poses = 18000;
};

class JointEstimator {
 public:
  // `worker`: solves; it outlives the estimator. Null: solved at once.
  JointEstimator(const Config& config, const Calibration& calibration, const Window& window = {},
                 Worker* worker = nullptr);
  ~JointEstimator();

  void on(const CameraPose& pose);
  void on(const SampledRead& read);

  [[nodiscard]] std::optional<MetricPose> newest_pose() const;  // nothing while the scale is open
  [[nodiscard]] std::uint64_t reads_rejected() const;

  // Appends what is known now: a TagEstimate per tag, ScaleEstimate per segment, Trajectory, and (final)
  // the same from all data.
  void publish(DeviceTime now, bool final, std::vector<Estimate>& out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo
