// The paper's estimator, sections III to V, equation by equation: for comparison and for the
// reproduction report. Per tag and antenna array: spectrum search (8), angle averaging (9)-(10),
// least-squares intersection of lines (13)-(17), Levenberg-Marquardt on distance differences
// (18)-(22), HDOP (23)-(28), selection by the smallest HDOP, trajectory (29).
#pragma once

#include <memory>
#include <vector>

#include "config/calibration.hpp"
#include "config/config.hpp"
#include "estimator/estimate.hpp"
#include "estimator/event.hpp"
#include "estimator/sampling_synchronization.hpp"

namespace rfmvo {

class PaperEstimator {
 public:
  PaperEstimator(const Config& config, const Calibration& calibration);
  ~PaperEstimator();

  void on(const CameraPose& pose);
  void on(const SampledRead& read);

  // Appends what is known now: a TagEstimate per tag, ScaleEstimate per segment, Trajectory, and (final)
  // the same from all data.
  void publish(DeviceTime now, bool final, std::vector<Estimate>& out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo
