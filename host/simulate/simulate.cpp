#include <algorithm>
#include <cmath>

#include "simulate/drift.hpp"
#include "simulate/radio_run.hpp"
#include "simulate/random.hpp"
#include "simulate/scene.hpp"

namespace rfmvo::simulate {
namespace {

constexpr DeviceTime kEpoch{1'767'225'600'000'000'000};  // 2026-01-01 00:00 UTC
constexpr double kTick_s = 1.0;
constexpr double kRenderedK1Sigma = 0.002, kRenderedReadoutSigma_s = 0.0005;  // of a good calibration
constexpr double kMaxGapShare = 0.5;  // of the run, so that a path is left on both sides

// Journals count microseconds.
DeviceTime at(double t_s) { return kEpoch + Duration{std::llround(t_s * 1e6) * 1000}; }

// The lever arms as a ruler finds them: off by what the calibration itself claims, 1 sigma. What the images'
// own camera is off by comes on top, and is in the images already.
Calibration nominal_of(const Scene& scene, std::uint64_t seed) {
  Calibration calibration = scene.calibration;
  calibration.camera_sigma_m = scene.frame_offset_sigma_m;
  calibration.camera_rotation_sigma_rad = scene.frame_rotation_sigma_rad;
  Random random(seed, "lever arm errors");
  for (AntennaCalibration& antenna : calibration.antennas) {
    for (int i = 0; i < 3; ++i) antenna.p_C_A_m[i] += antenna.lever_arm_sigma_m[i] * random.normal();
  }
  return calibration;
}

Truth truth_of(const Scene& scene) {
  // W is the cart at the first frame.
  const Rigid3 T_W_S = scene.calibration.T_B_C * scene.T_S_C(scene.start_s()).inverse();
  Truth truth;
  truth.calibration = scene.calibration;
  for (const SceneTag& tag : scene.tags) truth.tags.push_back({tag.epc, T_W_S * tag.p_S_X_m});
  for (const double t_s : scene.frame_times_s) truth.trajectory.push_back({at(t_s), T_W_S * scene.T_S_C(t_s)});
  return truth;
}

// Open interval in the middle of the run without a frame; empty for a length of 0.
struct FrameGap {
  double from_s, to_s;
  [[nodiscard]] bool holds(double t_s) const { return from_s < t_s && t_s < to_s; }
};

FrameGap frame_gap(const Scene& scene, double length_s) {
  const double middle_s = 0.5 * (scene.start_s() + scene.end_s());
  return {middle_s - 0.5 * length_s, middle_s + 0.5 * length_s};
}

// After a gap the odometry starts anew: a new segment, with its own V and scale.
DriftedPoses drift_around(const FrameGap& gap, const Truth& truth, const DriftClass& c, std::uint64_t seed) {
  if (gap.from_s >= gap.to_s) return drift(truth.trajectory, c, seed);
  std::vector<TruePose> before, after;
  for (const TruePose& pose : truth.trajectory) {
    if (pose.time <= at(gap.from_s)) before.push_back(pose);
    if (pose.time >= at(gap.to_s)) after.push_back(pose);
  }
  DriftedPoses drifted = drift(before, c, seed);
  for (CameraPose& pose : drift(after, c, seed, 1).poses) {
    pose.segment = 1;
    drifted.poses.push_back(pose);
  }
  return drifted;
}

// Everything but the frames, which are made one at a time when their turn comes.
std::vector<Event> small_events(const Scene& scene, const Options& options, const std::vector<CameraPose>& poses) {
  std::vector<Event> events;
  for (const CameraPose& pose : poses) events.emplace_back(pose);
  const DeviceTime late_epoch = kEpoch + Duration::from_seconds(options.reader_delay_s);
  for (const TagRead& read : make_reads(scene, options, late_epoch)) events.emplace_back(read);
  for (double t_s = scene.start_s() + kTick_s; t_s <= scene.end_s(); t_s += kTick_s) events.emplace_back(Tick{at(t_s)});
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return time_of(a) < time_of(b); });
  return events;
}

Status feed(const Scene& scene, bool with_frames, const FrameGap& gap, const std::vector<Event>& events,
            const Sink& sink) {
  std::size_t next = 0;
  for (std::size_t k = 0; k < scene.frame_times_s.size() && with_frames; ++k) {
    if (gap.holds(scene.frame_times_s[k])) continue;
    const DeviceTime time = at(scene.frame_times_s[k]);
    for (; next < events.size() && time_of(events[next]) < time; ++next) {
      if (Status s = sink(events[next]); !s.ok()) return s;
    }
    Result<Frame> made = scene.frame(k);
    if (!made.ok()) return made.error();
    Frame frame = std::move(made).value();
    frame.time = time;
    frame.sequence = static_cast<std::int64_t>(k);
    if (Status s = sink(std::move(frame)); !s.ok()) return s;
  }
  for (; next < events.size(); ++next) {
    if (Status s = sink(events[next]); !s.ok()) return s;
  }
  return Done{};
}

// The same events at other times.
Sink shifted(const Sink& sink, Duration shift) {
  return [sink, shift](const Event& event) {
    Event later = event;
    std::visit([shift](auto& e) { e.time = e.time + shift; }, later);
    if (auto* read = std::get_if<TagRead>(&later)) read->reader_time = read->reader_time + shift;
    return sink(later);
  };
}

Result<Truth> simulate_from_epoch(const Options& options, const Scene& scene, const Sink& sink);

}  // namespace

Result<Truth> simulate(const Options& options, const Sink& sink) {
  Result<Scene> made = make_scene(options);
  if (!made.ok()) return made.error();
  const Scene scene = std::move(made).value();
  if (!options.start) return simulate_from_epoch(options, scene, sink);
  const Duration shift = *options.start - at(scene.start_s());
  Result<Truth> truth = simulate_from_epoch(options, scene, shifted(sink, shift));
  if (!truth.ok()) return truth;
  Truth later = std::move(truth).value();
  for (TruePose& pose : later.trajectory) pose.time = pose.time + shift;
  return later;
}

namespace {

Result<Truth> simulate_from_epoch(const Options& options, const Scene& scene, const Sink& sink) {
  const std::optional<DriftClass> drift_class = find_drift_class(options.vo_class);
  if (!drift_class) {
    std::string known;
    for (const std::string& name : vo_class_names()) known += (known.empty() ? "" : ", ") + name;
    return Error{ErrorCode::kUnknownKey, "unknown odometry class '" + options.vo_class + "'; known: " + known,
                 "--vo-class"};
  }
  const bool with_frames = options.frames && scene.frame;
  if (options.frame_gap_s > kMaxGapShare * (scene.end_s() - scene.start_s()))
    return Error{ErrorCode::kOutOfRange, "is more than half of the run", "--frame-gap-s"};
  const FrameGap gap = frame_gap(scene, options.frame_gap_s);

  Truth truth = truth_of(scene);
  const DriftedPoses drifted = drift_around(gap, truth, *drift_class, options.seed);
  truth.scale_m_per_unit = drifted.scale_m_per_unit;

  Start start;
  start.time = at(scene.start_s());
  start.config.estimator.pose_source = with_frames ? "frames" : "poses";
  if (options.images_dir.empty()) {
    // The rendering camera is a pinhole, and its calibration says so; its data sheet tells the readout time.
    start.config.vision.readout_s = scene.camera_effects.readout_s;
    start.config.vision.k1_sigma = kRenderedK1Sigma;
    start.config.vision.readout_sigma_s = kRenderedReadoutSigma_s;
  }
  start.calibration = nominal_of(scene, options.seed);
  if (Status s = sink(start); !s.ok()) return s.error();
  if (Status s = feed(scene, with_frames, gap, small_events(scene, options, drifted.poses), sink); !s.ok())
    return s.error();
  return truth;
}

}  // namespace

}  // namespace rfmvo::simulate
