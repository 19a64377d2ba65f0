// The paper's estimator, sections III to V, equation by equation: for comparison and for the
// reproduction report. Per tag and antenna array: spectrum search (8), angle averaging (9)-(10),
// least-squares intersection of lines (13)-(17), Levenberg-Marquardt on distance differences
// (18)-(22), HDOP (23)-(28), selection by the smallest HDOP, trajectory (29).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "config/calibration.hpp"
#include "config/config.hpp"
#include "estimator/estimate.hpp"
#include "estimator/event.hpp"
#include "estimator/sampling_synchronization.hpp"
#include "estimator/tag_track.hpp"

namespace rfmvo {

class PaperEstimator {
 public:
  // What becomes of every antenna array, solved or not: only the one of least HDOP is published.
  using ArrayObserver = std::function<void(const Epc& epc, const SolvedArray& array)>;

  PaperEstimator(const Config& config, const Calibration& calibration, ArrayObserver observer = {});
  ~PaperEstimator();

  void on(const CameraPose& pose);
  void on(const SampledRead& read);

  // Appends what is known now: a TagEstimate per tag, ScaleEstimate per segment, Trajectory, and (final)
  // the same from all data.
  void publish(DeviceTime now, bool final, std::vector<Estimate>& out);

  // Over all tags so far.
  struct Counts {
    std::uint32_t tags = 0, tags_with_enough_reads = 0;      // L on one antenna
    std::uint32_t arrays_due = 0, arrays_without_range = 0;  // Eq. (4), (5) exclude each other, or no usable step
  };
  [[nodiscard]] Counts counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo
