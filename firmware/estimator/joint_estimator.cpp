#include "estimator/joint_estimator.hpp"

#include <algorithm>
#include <iterator>
#include <variant>

#include "estimator/joint_segment.hpp"
#include "estimator/segment_description.hpp"
#include "estimator/tag_map.hpp"

namespace rfmvo {
namespace {

bool holds(const JointSegment& s, std::uint32_t id) {
  return std::find(s.ids().begin(), s.ids().end(), id) != s.ids().end();
}

// Segments as solved, and what that says.
struct Solution {
  std::vector<JointSegment> segments;
  SegmentsDescription says;
};

}  // namespace

// Solving and describing take longer than the next frame can wait: a worker does it on copies. What it finds holds
// from a fixed number of publications later on, however long it took, so that a replay gives the bits of the live run.
struct JointEstimator::Impl {
  enum class Work { kSolve, kCloseWindow, kCloseLost };
  struct Job {
    Work work = Work::kSolve;
    std::shared_ptr<std::optional<Solution>> solution;  // the worker's until it was waited for
    int publications_left = 1;
  };

  Config config;
  Calibration calibration;
  Window window;
  InlineWorker at_once;
  Worker* worker = &at_once;
  // Of an earlier odometry segment that the newest may still be joined with, and the newest.
  std::vector<JointSegment> open;
  std::optional<JointSegment> next;  // the second half of the newest, which takes over
  std::vector<JointSegment> lost;    // not joined in time: to be closed
  std::optional<Job> job;
  std::vector<std::variant<CameraPose, SampledRead>> since;  // the job began
  SegmentsDescription says;                                  // of the open segments; paths only until published
  TagMap map{0.0};
  std::vector<Estimate> closed;  // scales and paths, until published
  double next_join_arc_V = 0.0;  // of the newest
  std::uint32_t revision = 0, published_revision = 0;
  std::uint64_t rejected = 0;

  [[nodiscard]] double fill(const JointSegment& s) const;
  [[nodiscard]] Solution solve(std::vector<JointSegment> segments, bool in_full, bool join, DeviceTime now) const;
  void start(Work work, std::vector<JointSegment> segments, bool join, DeviceTime now);
  void begin_job(DeviceTime now);
  void end_job();
  void accept(Solution solution);
  void close(Solution solution);
  void finish(DeviceTime now);
};

double JointEstimator::Impl::fill(const JointSegment& s) const {
  const double poses = static_cast<double>(s.path().poses().size()) / static_cast<double>(window.poses);
  return s.started() ? std::max(poses, s.length_m() / window.length_m) : poses;
}

// `in_full`: all of them, else the newest. `join`: the last two become one if they can.
Solution JointEstimator::Impl::solve(std::vector<JointSegment> segments, bool in_full, bool join,
                                     DeviceTime now) const {
  for (JointSegment& s : segments)
    if (in_full || &s == &segments.back()) s.solve(in_full);
  if (join && segments.size() > 1) {
    const auto depth = in_full ? JointSegment::Depth::kAside : JointSegment::Depth::kLook;
    if (auto both = segments.front().joined(segments.back(), depth)) {
      if (in_full) both->solve(true);
      segments = {std::move(*both)};
    }
  }
  SegmentsDescription description =
      describe_segments(segments, now, calibration.camera_rotation_sigma_rad, config.joint);
  return {std::move(segments), std::move(description)};
}

void JointEstimator::Impl::start(Work work, std::vector<JointSegment> segments, bool join, DeviceTime now) {
  constexpr int kSoon = 1, kInFull = 10;  // publications
  const bool in_full = work != Work::kSolve;
  job = {work, std::make_shared<std::optional<Solution>>(), in_full ? kInFull : kSoon};
  worker->start([this, in_full, join, now, copies = std::move(segments), solution = job->solution] {
    *solution = solve(copies, in_full, join, now);
  });
  since.clear();
}

void JointEstimator::Impl::begin_job(DeviceTime now) {
  if (!next && fill(open.back()) >= 0.5) next = open.back().following();
  if (!lost.empty()) return start(Work::kCloseLost, {lost.front()}, false, now);
  if (next && next->path().poses().size() > 1 && fill(open.back()) >= 1.0)
    return start(Work::kCloseWindow, open, false, now);
  // To join is tried again when the newest segment has grown by half: all tries together cost as much as a few.
  const double arc_V = open.back().path().arc_V();
  const bool join = open.size() > 1 && !next && arc_V > next_join_arc_V && open.back().scale_observable();
  if (join) next_join_arc_V = 1.5 * arc_V;
  start(Work::kSolve, open, join, now);
}

void JointEstimator::Impl::end_job() {
  worker->wait();
  Solution solution = std::move(job->solution->value());
  const Work work = job->work;
  job.reset();
  if (work == Work::kSolve) return accept(std::move(solution));
  if (work == Work::kCloseLost) {
    close(std::move(solution));
    lost.erase(lost.begin());
    return;
  }
  next->take_over(solution.segments.back());
  close(std::move(solution));
  open.clear();
  open.push_back(std::move(*next));
  next.reset();
  says = {};
}

// The solution, and what has come since.
void JointEstimator::Impl::accept(Solution solution) {
  open = std::move(solution.segments);
  says = std::move(solution.says);
  ++revision;
  for (const auto& item : since) {
    if (const auto* pose = std::get_if<CameraPose>(&item)) open.back().add(*pose);
    if (const auto* read = std::get_if<SampledRead>(&item))
      for (JointSegment& s : open)
        if (holds(s, read->segment)) s.add(*read);
  }
}

// The last word on all that the segments know.
void JointEstimator::Impl::close(Solution solution) {
  for (const auto& [epc, e] : solution.says.tags) {
    DeviceTime last_read;
    for (const JointSegment& s : solution.segments)
      if (s.tags().contains(epc)) last_read = std::max(last_read, s.tags().at(epc).last_read);
    map.keep(e, last_read);
  }
  for (const ScaleEstimate& scale : solution.says.scales) closed.emplace_back(scale);
  for (Trajectory& path : solution.says.paths) closed.emplace_back(std::move(path));
  ++revision;
}

void JointEstimator::Impl::finish(DeviceTime now) {
  if (job) end_job();
  for (JointSegment& s : lost) close(solve({std::move(s)}, true, false, now));
  lost.clear();
  since.clear();
  accept(solve(std::move(open), true, true, now));
}

JointEstimator::JointEstimator(const Config& config, const Calibration& calibration, const Window& window,
                               Worker* worker)
    : impl_(std::make_unique<Impl>()) {
  impl_->window = window;
  if (worker != nullptr) impl_->worker = worker;
  impl_->config = config;
  impl_->calibration = calibration;
  impl_->map = TagMap(config.joint.stale_after_s);
}
JointEstimator::~JointEstimator() {
  if (impl_->job) impl_->worker->wait();
}

void JointEstimator::on(const CameraPose& pose) {
  if (pose.status != VoStatus::kTracking && pose.status != VoStatus::kDegraded) return;
  Impl& impl = *impl_;
  if (impl.open.empty()) {
    impl.open.emplace_back(impl.config, impl.calibration, pose.segment, impl.calibration.T_B_C);
  } else if (impl.open.back().ids().back() != pose.segment) {
    if (impl.job) impl.end_job();  // rare, and simpler than a solution of segments that are no longer open
    if (impl.open.size() > 1) {
      impl.lost.push_back(std::move(impl.open.front()));
      impl.open.erase(impl.open.begin());
    }
    impl.next.reset();
    impl.next_join_arc_V = 0.0;
    impl.open.push_back(impl.open.back().after_loss(pose));
  }
  impl.open.back().add(pose);
  if (impl.next) impl.next->add(pose);
  if (impl.job) impl.since.emplace_back(pose);
}

void JointEstimator::on(const SampledRead& read) {
  Impl& impl = *impl_;
  for (JointSegment& s : impl.open) {
    if (!holds(s, read.segment)) continue;
    const std::uint64_t before = s.reads_rejected();
    s.add(read);
    impl.rejected += s.reads_rejected() - before;
  }
  if (impl.next && holds(*impl.next, read.segment)) impl.next->add(read);
  if (impl.job) impl.since.emplace_back(read);
}

std::uint64_t JointEstimator::reads_rejected() const { return impl_->rejected; }

void JointEstimator::publish(DeviceTime now, bool final, std::vector<Estimate>& out) {
  Impl& impl = *impl_;
  if (impl.open.empty()) return;
  if (final) {
    impl.finish(now);
  } else {
    if (impl.job && --impl.job->publications_left <= 0) impl.end_job();
    if (!impl.job) impl.begin_job(now);
  }
  std::move(impl.closed.begin(), impl.closed.end(), std::back_inserter(out));
  impl.closed.clear();
  if (impl.revision != impl.published_revision)
    out.emplace_back(MapRevision{now, impl.revision, final ? "final solution" : "new reads"});
  impl.published_revision = impl.revision;
  for (ScaleEstimate& scale : impl.says.scales) {
    scale.time = now;
    out.emplace_back(scale);
  }
  for (Trajectory& path : impl.says.paths)
    if (final || path.segment == impl.open.back().ids().back()) out.emplace_back(std::move(path));
  impl.says.paths.clear();
  for (const Epc& epc : impl.map.tags())
    if (!impl.says.tags.contains(epc)) out.emplace_back(impl.map.best(epc, nullptr, now));
  for (const auto& [epc, e] : impl.says.tags) out.emplace_back(impl.map.best(epc, &e, now));
}

std::optional<MetricPose> JointEstimator::newest_pose() const {
  if (impl_->open.empty()) return std::nullopt;
  const JointSegment& s = impl_->open.back();
  if (!s.scale_observable() || s.path().empty()) return std::nullopt;
  const PathPose& pose = s.path().poses().back();
  return MetricPose{pose.time, s.ids().back(), impl_->revision, s.T_W_C(pose), s.pose_covariance_W(pose)};
}

}  // namespace rfmvo
