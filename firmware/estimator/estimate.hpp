// The estimator's only output. Positions are in W: metric, REP-103 axes of the cart at the start of
// the first segment (x forward, y left, z up). Metres, radians.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/time.hpp"
#include "estimator/event.hpp"
#include "geometry/rigid.hpp"
#include "rf/epc.hpp"

namespace rfmvo {

// Ambiguity is not covariance: the covariance of a hypothesis describes that one, the status says whether
// there is only one. Where there are more (kMirror), the covariance of the tag itself is the second moment of
// all of them about the published position, so that who ignores the status is not misled.
enum class TagStatus : std::int8_t {
  kConverged = 0,
  kNoScale = 1,       // the metric scale is not observable yet
  kCircle = 2,        // a circle of positions fits (straight path, one antenna)
  kMirror = 3,        // two or more separate positions fit: see the hypotheses
  kWeakGeometry = 4,  // one position, but its sigma is above the configured limit
  kMoved = 5,         // the reads contradict the position held so far
  kStale = 6,         // not read for longer than the configured time
  kTooFewReads = 7,
};

struct TagHypothesis {
  Eigen::Vector3d p_W_X_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
  double weight = 1.0;  // posterior probability among the hypotheses of this tag
};

struct TagEstimate {
  DeviceTime time;
  Epc epc;
  TagStatus status = TagStatus::kTooFewReads;
  std::uint32_t segment = 0;
  std::uint32_t map_revision = 0;
  Eigen::Vector3d p_W_X_m = Eigen::Vector3d::Zero();  // the heaviest hypothesis
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
  Eigen::Vector3d covariance_with_log_scale_m = Eigen::Vector3d::Zero();  // E[dp dln(scale)]
  // The same position relative to the camera at its closest approach (path drift cancels there).
  DeviceTime closest_approach;
  Eigen::Vector3d p_C_X_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_C_m2 = Eigen::Matrix3d::Zero();
  double hdop = 0.0;               // Eq. (28): geometry only, x-y of W; 0 = not computed
  double bearing_sweep_rad = 0.0;  // angle over which the antennas saw the tag
  double independent_reads = 0.0;  // effective number, after the correlation of the phase error
  std::uint32_t reads = 0;
  std::vector<TagHypothesis> hypotheses;  // all that stand, the heaviest first
};

struct ScaleEstimate {
  DeviceTime time;
  std::uint32_t segment = 0;
  bool observable = false;
  double m_per_unit = 0.0;  // metres per unit of V (gamma of the paper)
  double log_sigma = 0.0;   // 1 sigma of ln(scale), so of the relative error
};

struct MetricPose {
  DeviceTime time;
  std::uint32_t segment = 0;
  std::uint32_t map_revision = 0;
  Rigid3 T_W_C;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  // position (m), rotation (rad), in W
};

// The recovered path as the newest map revision has it; replaces what was said of the segment from its first pose on.
struct Trajectory {
  DeviceTime time;
  std::uint32_t segment = 0;
  std::uint32_t map_revision = 0;
  std::vector<MetricPose> poses;
};

struct MapRevision {
  DeviceTime time;
  std::uint32_t revision = 0;
  std::string reason;
};

struct Health {
  DeviceTime time;
  VoStatus vo_status = VoStatus::kInitialising;
  std::uint32_t segment = 0;
  std::int32_t inliers = 0;
  std::uint64_t frames = 0, poses = 0, reads = 0;
  std::uint64_t reads_without_pose = 0;  // no camera pose on both sides of the read
  std::uint64_t reads_rejected = 0;      // SeenCount > 1, unknown port, foreign frequency
  std::uint32_t tags = 0, tags_located = 0;
  std::uint64_t faults = 0;
  std::string last_fault;
  ReaderStatus reader;  // the newest; its time is 0 if there was none
};

using Estimate = std::variant<CameraPose, TagEstimate, ScaleEstimate, MetricPose, Trajectory, MapRevision, Health>;

}  // namespace rfmvo
