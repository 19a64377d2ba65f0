#include "estimator/joint_estimator.hpp"

#include <algorithm>
#include <iterator>

#include "estimator/joint_segment.hpp"
#include "estimator/segment_description.hpp"
#include "estimator/tag_map.hpp"

namespace rfmvo {
struct JointEstimator::Impl {
  Config config;
  Calibration calibration;
  Window window;
  // Of an earlier odometry segment that the newest may still be joined with, and the newest.
  std::vector<JointSegment> open;
  std::optional<JointSegment> next;  // the second half of the newest, which takes over
  TagMap map{0.0};
  std::vector<Estimate> closed;  // paths and scales, to be published once
  double next_join_arc_V = 0.0;  // of the newest
  std::uint32_t revision = 0;    // of the map
  std::uint64_t solutions = 0;   // that it consists of
  std::uint64_t rejected = 0;    // reads, in closed windows

  [[nodiscard]] double fill(const JointSegment& s) const;
  void close(JointSegment& segment, DeviceTime now);
  void hand_over(DeviceTime now);
  void join_newest(JointSegment::Depth depth);
  void finish();
  [[nodiscard]] TagEstimate describe(const JointSegment& s, const Epc& epc, DeviceTime now) const {
    return describe_tag(s, epc, s.tags().at(epc), now, calibration.camera_rotation_sigma_rad, config.joint);
  }
};

double JointEstimator::Impl::fill(const JointSegment& s) const {
  const double poses = static_cast<double>(s.path().poses().size()) / static_cast<double>(window.poses);
  return s.started() ? std::max(poses, s.length_m() / window.length_m) : poses;
}

// The last word on all that the segment knows.
void JointEstimator::Impl::close(JointSegment& segment, DeviceTime now) {
  segment.solve(true);
  for (const auto& [epc, tag] : segment.tags()) map.keep(describe(segment, epc, now), tag.last_read);
  for (ScaleEstimate& scale : describe_scales(segment, now)) closed.emplace_back(scale);
  for (Trajectory& path : describe_paths(segment, now)) closed.emplace_back(std::move(path));
  rejected += segment.reads_rejected();
}

void JointEstimator::Impl::hand_over(DeviceTime now) {
  if (!next && fill(open.back()) >= 0.5) next = open.back().following();
  if (!next || fill(open.back()) < 1.0) return;
  for (JointSegment& s : open) close(s, now);
  next->take_over(open.back());
  open.clear();
  open.push_back(std::move(*next));
  next.reset();
}

// Tried again when the newest segment has grown by half: all tries together cost as much as a few.
void JointEstimator::Impl::join_newest(JointSegment::Depth depth) {
  if (open.size() < 2 || next || !open.back().scale_observable()) return;
  const double arc_V = open.back().path().arc_V();
  if (arc_V < next_join_arc_V) return;
  next_join_arc_V = 1.5 * arc_V;
  auto both = open[open.size() - 2].joined(open.back(), depth);
  if (!both) return;
  open.pop_back();
  open.back() = std::move(*both);
}

void JointEstimator::Impl::finish() {
  for (JointSegment& s : open) s.solve(true);
  next_join_arc_V = 0.0;
  const std::size_t apart = open.size();
  join_newest(JointSegment::Depth::kAside);
  if (open.size() < apart) open.back().solve(true);
}

JointEstimator::JointEstimator(const Config& config, const Calibration& calibration, const Window& window)
    : impl_(std::make_unique<Impl>()) {
  impl_->window = window;
  impl_->config = config;
  impl_->calibration = calibration;
  impl_->map = TagMap(config.joint.stale_after_s);
}
JointEstimator::~JointEstimator() = default;

void JointEstimator::on(const CameraPose& pose) {
  if (pose.status != VoStatus::kTracking && pose.status != VoStatus::kDegraded) return;
  auto& open = impl_->open;
  if (open.empty()) {
    open.emplace_back(impl_->config, impl_->calibration, pose.segment, impl_->calibration.T_B_C);
  } else if (open.back().ids().back() != pose.segment) {
    if (open.size() > 1) {
      impl_->close(open.front(), pose.time);
      open.erase(open.begin());
    }
    impl_->next.reset();
    impl_->next_join_arc_V = 0.0;
    open.push_back(open.back().after_loss(pose));
  }
  open.back().add(pose);
  if (impl_->next) impl_->next->add(pose);
}

void JointEstimator::on(const SampledRead& read) {
  const auto give = [&](JointSegment& s) {
    if (std::find(s.ids().begin(), s.ids().end(), read.segment) != s.ids().end()) s.add(read);
  };
  for (JointSegment& s : impl_->open) give(s);
  if (impl_->next) give(*impl_->next);
}

std::uint64_t JointEstimator::reads_rejected() const {
  std::uint64_t n = impl_->rejected;
  for (const JointSegment& s : impl_->open) n += s.reads_rejected();
  return n;
}

void JointEstimator::publish(DeviceTime now, bool final, std::vector<Estimate>& out) {
  auto& open = impl_->open;
  if (open.empty()) return;
  if (final) {
    impl_->finish();
  } else {
    open.back().solve(false);
    impl_->join_newest(JointSegment::Depth::kLook);
    impl_->hand_over(now);
  }
  std::move(impl_->closed.begin(), impl_->closed.end(), std::back_inserter(out));
  impl_->closed.clear();
  std::uint64_t solutions = 0;
  for (const JointSegment& s : open) solutions += s.revision();
  if (solutions != impl_->solutions) {
    ++impl_->revision;
    out.emplace_back(MapRevision{now, impl_->revision, final ? "final solution" : "new reads"});
  }
  impl_->solutions = solutions;

  std::map<Epc, TagEstimate> found;
  for (const JointSegment& s : open) {
    for (const auto& [epc, tag] : s.tags()) {
      TagEstimate e = impl_->describe(s, epc, now);
      const auto [place, first] = found.try_emplace(epc, e);
      if (!first && says_more(e, place->second)) place->second = std::move(e);
    }
    for (const ScaleEstimate& scale : describe_scales(s, now)) out.emplace_back(scale);
    if (final || &s == &open.back())
      for (Trajectory& path : describe_paths(s, now)) out.emplace_back(std::move(path));
  }
  for (const Epc& epc : impl_->map.tags())
    if (!found.contains(epc)) out.emplace_back(impl_->map.best(epc, nullptr, now));
  for (const auto& [epc, e] : found) out.emplace_back(impl_->map.best(epc, &e, now));
}

std::optional<MetricPose> JointEstimator::newest_pose() const {
  if (impl_->open.empty()) return std::nullopt;
  const JointSegment& s = impl_->open.back();
  if (!s.scale_observable() || s.path().empty()) return std::nullopt;
  const PathPose& pose = s.path().poses().back();
  return MetricPose{pose.time, s.ids().back(), s.revision(), s.T_W_C(pose), s.pose_covariance_W(pose)};
}

}  // namespace rfmvo
