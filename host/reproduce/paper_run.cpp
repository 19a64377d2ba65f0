#include "reproduce/paper_run.hpp"

#include <cmath>
#include <map>

#include "estimator/paper_estimator.hpp"
#include "estimator/trajectory_recovery.hpp"
#include "evaluate/alignment.hpp"
#include "montecarlo/cpu_time.hpp"
#include "reproduce/scale_windows.hpp"

namespace rfmvo::reproduce {
namespace {

constexpr int kPathSamples = 21;  // of the true path over an array

// Collects what the estimator would throw away.
class Collector {
 public:
  Collector(const montecarlo::Recording& recording, const Calibration& calibration)
      : truth_(recording.truth), recovery_(calibration.T_B_C) {
    for (std::size_t n = 0; n < truth_.tags.size(); ++n) tags_[truth_.tags[n].epc] = n;
    run_.search_error_m.resize(tags_.size());
    run_.error_m.resize(tags_.size());
    search_hdop_.resize(tags_.size(), 0.0);
    hdop_.resize(tags_.size(), 0.0);
    start_ = time_of(recording.events.front());
  }

  void on(const CameraPose& pose) {
    odometry_.push_back(pose);
    recovery_.on(pose);
  }

  void on(const Epc& epc, const SolvedArray& array) {
    if (array.searched.found && array.searched.hdop.defined)
      recovery_.on(ScaleCandidate{array.first, array.last, array.searched.gamma, 0.0, array.searched.hdop.value});
    const auto tag = tags_.find(epc);
    const auto T_W_C = evaluate::truth_at(truth_.trajectory, array.first);
    if (tag == tags_.end() || !T_W_C) return;
    ArrayResult result = geometry_of(tag->second, array);
    // Eq. (30) in the axes of the camera at the array's first read: the paper's has no rotation.
    const Eigen::Vector3d p_C_X = T_W_C->inverse() * truth_.tags[tag->second].p_W_X_m;
    const auto error_m = [&](const Eigen::Vector3d& p_V_X) { return (array.R_V_C.conjugate() * p_V_X - p_C_X).norm(); };
    const auto scale_error = [&](double gamma) -> std::optional<ScaleError> {
      if (!(result.true_gamma > 0.0)) return std::nullopt;
      const double off = std::abs(gamma - result.true_gamma);
      return ScaleError{off, off / result.true_gamma};
    };
    if (array.searched.found && array.searched.hdop.defined) {
      result.search_error_m = error_m(array.searched.p_X_m);
      result.search_scale_error = scale_error(array.searched.gamma);
      keep(search_hdop_[result.tag], run_.search_error_m[result.tag], array.searched.hdop, *result.search_error_m);
    }
    if (array.solution.found && array.hdop.defined) {
      result.error_m = error_m(array.solution.p_X_m);
      result.scale_error = scale_error(array.solution.gamma);
      keep(hdop_[result.tag], run_.error_m[result.tag], array.hdop, *result.error_m);
    }
    run_.arrays.push_back(result);
  }

  [[nodiscard]] PaperRun finish(const PaperEstimator& estimator, const std::vector<Estimate>& last) {
    const PaperEstimator::Counts counts = estimator.counts();
    run_.tags = truth_.tags.size();
    run_.tags_with_enough_reads = counts.tags_with_enough_reads;
    run_.arrays_due = counts.arrays_due;
    run_.arrays_without_range = counts.arrays_without_range;
    run_.search_scale = window_scale_errors(recovery_.path(), odometry_, truth_.trajectory);
    for (const MetricPose& pose : recovery_.path()) run_.search_path_m.push_back(pose.T_W_C.t);
    for (const Estimate& estimate : last) {
      const auto* trajectory = std::get_if<Trajectory>(&estimate);
      if (trajectory == nullptr) continue;
      run_.scale = window_scale_errors(trajectory->poses, odometry_, truth_.trajectory);
      for (const MetricPose& pose : trajectory->poses) run_.path_m.push_back(pose.T_W_C.t);
    }
    return std::move(run_);
  }

 private:
  // Section VII.C: the position of least HDOP over the arrays of a tag.
  static void keep(double& least, std::optional<double>& kept_m, const Hdop& hdop, double error_m) {
    if (kept_m && hdop.value >= least) return;
    least = hdop.value;
    kept_m = error_m;
  }

  [[nodiscard]] ArrayResult geometry_of(std::size_t tag, const SolvedArray& array) const {
    ArrayResult result;
    result.tag = tag;
    result.middle_s = 0.5 * ((array.first - start_).seconds() + (array.last - start_).seconds());
    result.span_s = (array.last - array.first).seconds();
    add_path(truth_.tags[tag].p_W_X_m, array, result);
    result.hdop = array.hdop.defined ? array.hdop.value : 0.0;
    result.true_gamma = true_gamma(odometry_, truth_.trajectory, array.first, array.last);
    result.holds_truth = array.range.min <= result.true_gamma && result.true_gamma <= array.range.max;
    result.converged = array.solution.converged;
    return result;
  }

  // Distance of the tag and way of the camera, from samples over the array's time.
  void add_path(const Eigen::Vector3d& p_W_X, const SolvedArray& array, ArrayResult& result) const {
    double sum_m = 0.0, distances = 0.0;
    std::optional<Rigid3> before;
    for (int i = 0; i < kPathSamples; ++i) {
      const DeviceTime t{array.first.ns + (array.last.ns - array.first.ns) * i / (kPathSamples - 1)};
      const auto T_W_C = evaluate::truth_at(truth_.trajectory, t);
      if (!T_W_C) continue;
      if (before) result.travel_m += (T_W_C->t - before->t).norm();
      before = T_W_C;
      for (const AntennaCalibration& antenna : truth_.calibration.antennas) {
        sum_m += (*T_W_C * antenna.p_C_A_m - p_W_X).norm();
        distances += 1.0;
      }
    }
    result.distance_m = distances > 0.0 ? sum_m / distances : 0.0;
  }

  const simulate::Truth& truth_;
  std::map<Epc, std::size_t> tags_;
  std::vector<double> search_hdop_, hdop_;  // least so far, by tag
  std::vector<CameraPose> odometry_;
  TrajectoryRecovery recovery_;  // Eq. (29) with the scales of section III alone
  DeviceTime start_;
  PaperRun run_;
};

}  // namespace

PaperRun run_paper(const montecarlo::Recording& recording, const Config& config) {
  const Calibration& calibration = std::get<Start>(recording.events.front()).calibration;
  Collector collector(recording, calibration);
  SamplingSynchronization synchronization(config);
  PaperEstimator estimator(config, calibration,
                           [&](const Epc& epc, const SolvedArray& array) { collector.on(epc, array); });
  std::vector<Estimate> out;
  DeviceTime last_publish = time_of(recording.events.front());
  const double before_s = montecarlo::thread_cpu_s();
  const auto feed = [&](const std::vector<SampledRead>& reads) {
    for (const SampledRead& read : reads) estimator.on(read);
  };
  for (const Event& event : recording.events) {
    if (const auto* pose = std::get_if<CameraPose>(&event)) {
      collector.on(*pose);
      estimator.on(*pose);
      feed(synchronization.on(*pose));
    } else if (const auto* read = std::get_if<TagRead>(&event)) {
      feed(synchronization.on(*read));
    }
    const DeviceTime now = time_of(event);
    if ((now - last_publish).seconds() < config.estimator.publish_interval_s) continue;
    out.clear();
    estimator.publish(now, false, out);
    last_publish = now;
  }
  out.clear();
  estimator.publish(time_of(recording.events.back()), true, out);
  const double cpu_s = montecarlo::thread_cpu_s() - before_s;
  PaperRun run = collector.finish(estimator, out);
  run.cpu_s = cpu_s;
  return run;
}

void repair(PaperConfig& paper) {
  paper.fix_rotation = paper.fix_sphere_average = paper.fix_cycles = paper.fix_scale_range = true;
}

}  // namespace rfmvo::reproduce
