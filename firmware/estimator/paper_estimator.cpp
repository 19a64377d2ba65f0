#include "estimator/paper_estimator.hpp"

#include <cmath>
#include <map>
#include <optional>

#include "estimator/trajectory_recovery.hpp"

namespace rfmvo {
namespace {

// A tag not read for this long has been passed: its last arrays are solved with what there is.
constexpr double kPassOver_s = 5.0;

// Relative sigma of the scale of one array, from the covariance of (X_T, gamma).
double log_sigma_of(const ArraySolution& solution) { return std::sqrt(solution.covariance(3, 3)) / solution.gamma; }

struct Tag {
  explicit Tag(TagTrack t) : track(std::move(t)) {}
  TagTrack track;
  std::optional<SolvedArray> best;     // least HDOP in the current segment
  std::optional<TagEstimate> earlier;  // best of the segments before
};

// Where the recovered path comes nearest to the tag, while the array was read.
const MetricPose* closest_pose(const std::vector<MetricPose>& path, const SolvedArray& array,
                               const Eigen::Vector3d& p_W_X_m) {
  const MetricPose* closest = nullptr;
  double least = 0.0;
  for (const MetricPose& pose : path) {
    if (pose.time < array.first || pose.time > array.last) continue;
    const double distance = (p_W_X_m - pose.T_W_C.t).norm();
    if (closest != nullptr && distance >= least) continue;
    closest = &pose;
    least = distance;
  }
  return closest;
}

TagEstimate estimate_of(const SolvedArray& array, const std::vector<MetricPose>& path, const Eigen::Quaterniond& R_W_V,
                        std::uint32_t segment) {
  const ArraySolution& s = array.solution;
  TagEstimate e;
  e.status = TagStatus::kConverged;  // the paper knows no other
  e.segment = segment;
  e.p_W_X_m = position_at(path, array.first) + R_W_V * s.p_X_m;
  // The paper gives no covariance. This is that of Eq. (18) alone: residual variance times (J'J)^-1, as if
  // the errors were white and the camera path perfect. It is a lower limit, not an honest sigma.
  const Eigen::Matrix3d R = R_W_V.toRotationMatrix();
  e.covariance_m2 = R * s.covariance.topLeftCorner<3, 3>() * R.transpose();
  e.covariance_with_log_scale_m = R * s.covariance.topRightCorner<3, 1>() / s.gamma;
  e.hdop = array.hdop.value;
  e.bearing_sweep_rad = array.bearing_sweep_rad;
  e.independent_reads = static_cast<double>(array.reads);
  e.hypotheses.push_back({e.p_W_X_m, e.covariance_m2, 1.0});
  if (const MetricPose* pose = closest_pose(path, array, e.p_W_X_m)) {
    e.closest_approach = pose->time;
    const Eigen::Matrix3d R_C_W = pose->T_W_C.R.conjugate().toRotationMatrix();
    e.p_C_X_m = R_C_W * (e.p_W_X_m - pose->T_W_C.t);
    e.covariance_C_m2 = R_C_W * e.covariance_m2 * R_C_W.transpose();
  }
  return e;
}

}  // namespace

struct PaperEstimator::Impl {
  Impl(const Config& c, const Calibration& k, ArrayObserver o)
      : config(c.paper), antennas(k.antennas), observer(std::move(o)), recovery(k.T_B_C) {}

  [[nodiscard]] std::optional<std::size_t> antenna_of(std::uint8_t port) const {
    for (std::size_t a = 0; a < antennas.size(); ++a)
      if (antennas[a].port == port) return a;
    return std::nullopt;
  }

  // Solves the tag's complete arrays (`all`: all there are); Section V keeps the one of least HDOP.
  void solve(const Epc& epc, Tag& tag, bool all) {
    while (auto array = tag.track.solve_next(all, phases, recovery.R_W_V())) {
      if (observer) observer(epc, *array);
      if (!array->solution.found || !array->hdop.defined) continue;
      recovery.on(ScaleCandidate{array->first, array->last, array->solution.gamma, log_sigma_of(array->solution),
                                 array->hdop.value});
      if (!tag.best || array->hdop.value < tag.best->hdop.value) tag.best = std::move(array);
    }
  }

  void end_segment() {
    for (auto& [epc, tag] : tags) solve(epc, tag, true);
    const std::vector<MetricPose> path = recovery.path();
    for (auto& [epc, tag] : tags) {
      if (tag.best && (!tag.earlier || tag.best->hdop.value < tag.earlier->hdop))
        tag.earlier = estimate_of(*tag.best, path, recovery.R_W_V(), recovery.segment());
      tag.best.reset();
      tag.track.begin_segment();
    }
  }

  TagEstimate tag_estimate(const Epc& epc, const Tag& tag, DeviceTime now, const std::vector<MetricPose>& path) const {
    TagEstimate e;
    if (tag.best && (!tag.earlier || tag.best->hdop.value < tag.earlier->hdop)) {
      e = estimate_of(*tag.best, path, recovery.R_W_V(), recovery.segment());
    } else if (tag.earlier) {
      e = *tag.earlier;
    } else {
      e.segment = recovery.segment();
      // L reads, but no array has a scale: the limits (4), (5) exclude each other, or the lines are parallel.
      e.status = tag.track.enough_reads() ? TagStatus::kNoScale : TagStatus::kTooFewReads;
    }
    e.time = now;
    e.epc = epc;
    e.reads = tag.track.reads();
    return e;
  }

  PaperConfig config;
  std::vector<AntennaCalibration> antennas;
  ArrayObserver observer;
  PhaseCalibration phases;
  TrajectoryRecovery recovery;
  std::map<Epc, Tag> tags;
  bool started = false;
};

PaperEstimator::PaperEstimator(const Config& config, const Calibration& calibration, ArrayObserver observer)
    : impl_(std::make_unique<Impl>(config, calibration, std::move(observer))) {}
PaperEstimator::~PaperEstimator() = default;

void PaperEstimator::on(const CameraPose& pose) {
  if (pose.status != VoStatus::kTracking && pose.status != VoStatus::kDegraded) return;
  if (impl_->started && pose.segment != impl_->recovery.segment()) impl_->end_segment();
  impl_->started = true;
  impl_->recovery.on(pose);
}

void PaperEstimator::on(const SampledRead& read) {
  const auto antenna = impl_->antenna_of(read.read.port);
  if (!antenna || !impl_->started || read.segment != impl_->recovery.segment()) return;
  if (read.read.seen_count > 1 || read.read.frequency_hz == 0) return;  // no phase, no wavelength
  const auto [found, is_new] = impl_->tags.try_emplace(read.read.epc, TagTrack(impl_->config, impl_->antennas));
  Tag& tag = found->second;
  if (const SampledRead* before = tag.track.newest(*antenna)) impl_->phases.on_pair(before->read, read.read);
  tag.track.on(*antenna, read, impl_->phases);
  impl_->solve(read.read.epc, tag, false);
}

void PaperEstimator::publish(DeviceTime now, bool final, std::vector<Estimate>& out) {
  for (auto& [epc, tag] : impl_->tags)
    if (final || !tag.best || (now - tag.track.last_read()).seconds() > kPassOver_s) impl_->solve(epc, tag, true);

  const std::vector<MetricPose> path = impl_->recovery.path();
  for (const auto& [epc, tag] : impl_->tags) out.emplace_back(impl_->tag_estimate(epc, tag, now, path));
  if (!impl_->started) return;
  ScaleEstimate scale;
  scale.time = now;
  scale.segment = impl_->recovery.segment();
  if (const auto& best = impl_->recovery.best()) {
    scale.observable = true;  // the paper knows no other; log_sigma is that of Eq. (18) alone
    scale.m_per_unit = best->gamma;
    scale.log_sigma = best->log_sigma;
  }
  out.emplace_back(scale);
  Trajectory trajectory;
  trajectory.time = now;
  trajectory.segment = impl_->recovery.segment();
  trajectory.poses = path;
  out.emplace_back(std::move(trajectory));
}

PaperEstimator::Counts PaperEstimator::counts() const {
  Counts counts;
  for (const auto& [epc, tag] : impl_->tags) {
    ++counts.tags;
    if (tag.track.enough_reads()) ++counts.tags_with_enough_reads;
    counts.arrays_due += tag.track.arrays_due();
    counts.arrays_without_range += tag.track.arrays_without_range();
  }
  return counts;
}

}  // namespace rfmvo
