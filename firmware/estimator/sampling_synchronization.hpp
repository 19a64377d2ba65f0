// Stage 1, sampling synchronization (paper section II): each tag read gets the camera pose of ITS
// time. Differs from the paper, which takes the nearest frame: at 1 m/s and 30 fps that is 0.37 rad
// rms of phase error; we interpolate on SE(3) between the two poses around the read.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/time.hpp"
#include "config/config.hpp"
#include "estimator/event.hpp"
#include "rf/tag_read.hpp"

namespace rfmvo {

struct SampledRead {
  TagRead read;
  std::uint32_t segment = 0;
  UnscaledPose T_V_C;                                            // camera at the read's time
  Eigen::Vector3d velocity_V = Eigen::Vector3d::Zero();          // units of V per second
  Eigen::Vector3d angular_velocity_C = Eigen::Vector3d::Zero();  // rad/s
};

class SamplingSynchronization {
 public:
  explicit SamplingSynchronization(const Config& config);

  // Both return the reads that became complete, in time order; valid until the next call.
  const std::vector<SampledRead>& on(const CameraPose& pose);
  const std::vector<SampledRead>& on(const TagRead& read);

  [[nodiscard]] std::uint64_t reads_without_pose() const { return reads_without_pose_; }

 private:
  void release();

  Duration max_gap_;
  // Vectors, though they are emptied from the front: once they have their size, a read allocates nothing.
  std::vector<CameraPose> poses_;  // the last few, time-ordered, of one segment
  std::vector<TagRead> waiting_;   // reads newer than the newest pose
  std::vector<SampledRead> ready_;
  std::uint64_t reads_without_pose_ = 0;
};

}  // namespace rfmvo
