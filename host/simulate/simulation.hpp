// A simulated run: the events that the box would have recorded, and the truth beside them. The
// physics here shares no code with the estimator's phase model.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "config/calibration.hpp"
#include "estimator/event.hpp"

namespace rfmvo::simulate {

struct Options {
  std::string scene = "aisle";  // one of scene_names()
  std::string images_dir;       // real image sequence with metric truth; empty = synthetic
  std::uint64_t seed = 1;
  std::string vo_class = "NOMINAL";  // drift of the CameraPose events: PERFECT | BEST | NOMINAL | DEGRADED | BAD
  bool frames = true;                // false: no Frame events (fast; for replay from poses)
  std::optional<DeviceTime> start;   // device time of the first frame; nothing: 2026-01-01 plus the scene's own time
  double reader_delay_s = 0.0;       // read stamps are late by this much against the camera's
  // Stress. Each draws from a stream of its own: what it does not touch stays as it was.
  double outlier_share = 0.0;            // of the reads: a phase that tells nothing (uniform)
  double flip_share = 0.003;             // of the reads: turned by pi, in bursts; measured, DESIGN 2.8
  double frame_gap_s = 0.0;              // no frame and no camera pose for this long, in the middle of the run
  std::optional<double> structured_rad;  // strength of the structured phase error; nothing: the scene's own
  std::size_t tags = 0;                  // 0: the scene's own number
  std::optional<double> read_rate_hz;    // of the statistical inventory; nothing: the scene's own
  std::optional<double> duration_s;      // of a drive (shelf05 .. corridor); nothing: the scene's own
};

struct TrueTag {
  Epc epc;
  Eigen::Vector3d p_W_X_m;
};

struct TruePose {
  DeviceTime time;
  Rigid3 T_W_C;
};

// W of the truth: REP-103 axes of the cart at the start, as the estimator defines it; evaluation
// aligns by SE(3) anyway.
struct Truth {
  std::vector<TrueTag> tags;
  std::vector<TruePose> trajectory;  // at the frame times
  Calibration calibration;           // the true one (the journal carries the nominal one)
  double scale_m_per_unit = 1.0;     // of the CameraPose events
};

[[nodiscard]] std::vector<std::string> scene_names();
[[nodiscard]] std::vector<std::string> vo_class_names();
// Scenes in which position or scale of some tag is not observable, or ambiguous, on purpose.
[[nodiscard]] bool is_degenerate_scene(const std::string& name);

using Sink = std::function<Status(const Event&)>;

// Feeds `sink` with the run's events in time order (Start first). Same options, same events, bit for bit.
[[nodiscard]] Result<Truth> simulate(const Options& options, const Sink& sink);

// The pictures of a scene as an image folder: images/000000.jpg .., times.txt, calib.txt, groundtruth.txt (TUM,
// T_W_C of the camera, at every picture). Errors: kUnsupported for a scene without pictures, kUnwritable.
[[nodiscard]] Status write_image_folder(const Options& options, const std::string& directory);

// tags.csv (epc,x_m,y_m,z_m), trajectory.tum (t tx ty tz qx qy qz qw of T_W_C), antennas.toml (the
// true calibration), scale.csv (m_per_unit). Each file is written under a temporary name and renamed.
[[nodiscard]] Status write_truth(const Truth& truth, const std::string& directory);
[[nodiscard]] Result<Truth> read_truth(const std::string& directory);

}  // namespace rfmvo::simulate
