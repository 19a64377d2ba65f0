// Follows the camera through a map that grows with it: one pose per frame, key frames now and then.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "vision/lens.hpp"
#include "vision/map.hpp"
#include "vision/mapping.hpp"
#include "vision/motion_solver.hpp"
#include "vision/settled_path.hpp"

namespace rfmvo {

struct MapTrackerOptions {
  int max_tracks = 200;
  MappingOptions mapping;
};

struct TrackedPose {
  ViewPose T_C_V;
  int inliers = 0;
  double inlier_share = 0.0;               // of the located tracks that are kept
  double median_depth = 1.0;               // units of V
  Matrix6d covariance = Matrix6d::Zero();  // of this pose against the map; step of moved()
  // How much of the way from one key frame to the next was made since the pose before.
  double keyframe_share = 0.0;
  bool relocalised = false;  // nothing is known of the way since the pose before
};

class MapTracker {
 public:
  MapTracker(const MapTrackerOptions& options, const Lens& lens) : options_(options), lens_(lens) {}

  // Starts from a map whose newest key frame is this image.
  void begin(Map map, std::vector<Track> tracks, Pyramid pyramid, std::int64_t next_landmark);

  // The next frame. No value: the pose was not found; the frame is then as if it had never been.
  [[nodiscard]] std::optional<TrackedPose> on(DeviceTime time, const Pyramid& pyramid);

  // Likewise after a gap, when the last pose tells little: by descriptors, then as on(). Sterner than on(): a wrong
  // place would be worse than a new segment.
  [[nodiscard]] std::optional<TrackedPose> relocalise(DeviceTime time, const Pyramid& pyramid);

  // drift_per_keyframe() of the map a few frames ago, if ever it was known.
  [[nodiscard]] const std::optional<Matrix6d>& drift() const { return drift_; }

  [[nodiscard]] std::int64_t next_landmark() const { return next_landmark_; }
  [[nodiscard]] DeviceTime pose_time() const { return pose_time_; }
  [[nodiscard]] const Lens& lens() const { return lens_; }
  [[nodiscard]] const Map& map() const { return map_; }
  [[nodiscard]] std::span<const Track> tracks() const { return tracks_; }
  // Poses that have settled since the last call; all of them if the segment ends.
  [[nodiscard]] std::vector<SettledPose> take_settled(bool segment_ends);

 private:
  [[nodiscard]] const Landmark* located(const Track& track) const;
  [[nodiscard]] ViewPose predict(DeviceTime time) const;
  [[nodiscard]] std::vector<cv::Point2f> predict_tracks(const ViewPose& T_C_V) const;
  [[nodiscard]] MotionSolution locate_camera(const ViewPose& predicted, DeviceTime time,
                                             std::vector<Track>& followed) const;
  // Goes on from a pose that was found.
  TrackedPose accept(DeviceTime time, const Pyramid& pyramid, std::vector<Track> followed, const MotionSolution& s);
  // Median, without what rotation explains, in units of what makes a key frame.
  [[nodiscard]] double flow_since_keyframe() const;
  void rematch_tracks(const Pyramid& pyramid);
  void add_keyframe(DeviceTime time, const Pyramid& pyramid);
  void fill_up(const Pyramid& pyramid);
  void update_median_depth();
  void update_gate(const MotionSolution& solution);
  void update_drift(DeviceTime time);
  [[nodiscard]] double spend_flow(double flow);
  void update_motion(const ViewPose& T_C_V, DeviceTime time);

  MapTrackerOptions options_;  // the gate follows the noise
  const double widest_gate_px_ = options_.mapping.gate_px;
  double noise_px_ = widest_gate_px_;  // of a track, per axis
  Lens lens_;
  Map map_;
  std::vector<Track> tracks_;  // sorted by landmark; where they are in previous_
  Pyramid previous_;
  std::int64_t next_landmark_ = 0;
  DeviceTime pose_time_;
  ViewPose T_C_V_;   // the newest pose
  ViewPose motion_;  // T_C2_C1 of the two newest poses
  double motion_s_ = 0.0;
  Twist twist_;  // of the newest pose
  double median_depth_ = 1.0;
  SettledPath settled_;
  std::optional<Matrix6d> drift_;
  DeviceTime drift_time_;
  double flow_ = 0.0;                // the largest since the newest key frame
  bool rematched_ = false;           // since the newest key frame
  std::size_t keyframe_tracks_ = 0;  // when the newest key frame was made
};

}  // namespace rfmvo
