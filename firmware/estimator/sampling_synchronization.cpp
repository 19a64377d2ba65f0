#include "estimator/sampling_synchronization.hpp"

#include <algorithm>

namespace rfmvo {
namespace {

constexpr std::size_t kMaxPoses = 128;     // about 4 s at 30 fps
constexpr std::size_t kMaxWaiting = 4096;  // about 4 s at the fastest reader's 1000 reads/s

bool usable(const CameraPose& pose) { return pose.status == VoStatus::kTracking || pose.status == VoStatus::kDegraded; }

SampledRead sample(const CameraPose& a, const CameraPose& b, const TagRead& read) {
  const double span_s = (b.time - a.time).seconds();
  const double f = (read.time - a.time).seconds() / span_s;
  SampledRead s;
  s.read = read;
  s.segment = a.segment;
  s.T_V_C = interpolate(a.T_V_C, b.T_V_C, f);
  s.velocity_V = (b.T_V_C.p_V_C - a.T_V_C.p_V_C) / span_s;
  s.angular_velocity_C = so3_log(a.T_V_C.R_V_C.conjugate() * b.T_V_C.R_V_C) / span_s;
  return s;
}

}  // namespace

SamplingSynchronization::SamplingSynchronization(const Config& config)
    : max_gap_(Duration::from_seconds(config.sync.max_pose_gap_s)) {}

const std::vector<SampledRead>& SamplingSynchronization::on(const CameraPose& pose) {
  ready_.clear();
  if (!usable(pose)) return ready_;
  // Poses of another segment, or from before, cannot bracket a read together with this one.
  if (!poses_.empty() && (pose.segment != poses_.back().segment || pose.time <= poses_.back().time)) poses_.clear();
  poses_.push_back(pose);
  if (poses_.size() > kMaxPoses) poses_.erase(poses_.begin());
  release();
  return ready_;
}

const std::vector<SampledRead>& SamplingSynchronization::on(const TagRead& read) {
  ready_.clear();
  // Reads come nearly in order; keep the queue sorted by time (stable for equal times).
  const auto place = std::upper_bound(waiting_.begin(), waiting_.end(), read.time,
                                      [](DeviceTime t, const TagRead& r) { return t < r.time; });
  waiting_.insert(place, read);
  if (waiting_.size() > kMaxWaiting) {
    waiting_.erase(waiting_.begin());
    ++reads_without_pose_;
  }
  release();
  return ready_;
}

void SamplingSynchronization::release() {
  auto read = waiting_.begin();
  for (; read != waiting_.end() && !poses_.empty() && read->time <= poses_.back().time; ++read) {
    const auto after = std::lower_bound(poses_.begin(), poses_.end(), read->time,
                                        [](const CameraPose& p, DeviceTime t) { return p.time < t; });
    const bool bracketed = after != poses_.begin() && after->time - std::prev(after)->time <= max_gap_;
    if (bracketed)
      ready_.push_back(sample(*std::prev(after), *after, *read));
    else
      ++reads_without_pose_;
  }
  waiting_.erase(waiting_.begin(), read);
}

}  // namespace rfmvo
