// The visual odometry alone over a recorded sequence, with what it cost.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "edges/event_io.hpp"
#include "vision/visual_odometry.hpp"

namespace rfmvo::odometry {

struct Run {
  std::vector<CameraPose> poses;     // one per frame, as they came
  std::vector<SettledPose> settled;  // after bundle adjustment
  std::vector<double> cpu_ms;        // per frame, all threads, without decoding the image
  double total_cpu_s = 0.0;          // with decoding
  double peak_memory_mb = 0.0;       // of the whole process
  double k1 = 0.0, readout_s = 0.0;  // of the lens, as estimated in the end
};

struct RunOptions {
  std::vector<std::string> settings;  // section.key=value, over the journal's own configuration
  std::optional<CameraModel> camera;  // instead of the recorded one
};

// Called after every frame; an error ends the run.
using Watch = std::function<Status(const Frame&, const CameraPose&, const VisualOdometry&)>;

// Frames before a Start are an error; a second Start begins with a new odometry. Errors: those of the source,
// of a setting, of an image that cannot be decoded.
[[nodiscard]] Result<Run> run_odometry(EventSource& source, const RunOptions& options, const Watch& watch = {});

[[nodiscard]] inline bool has_pose(const CameraPose& p) {
  return p.status == VoStatus::kTracking || p.status == VoStatus::kDegraded;
}

}  // namespace rfmvo::odometry
