#include "report/report_data.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace rfmvo::report {
namespace {

DeviceTime time_of_estimate(const Estimate& estimate) {
  return std::visit([](const auto& e) { return e.time; }, estimate);
}

void set_time_span(const std::vector<Estimate>& estimates, ReportData& data) {
  if (estimates.empty()) return;
  DeviceTime first = time_of_estimate(estimates.front()), last = first;
  for (const Estimate& estimate : estimates) {
    first = std::min(first, time_of_estimate(estimate));
    last = std::max(last, time_of_estimate(estimate));
  }
  data.start = first;
  data.duration = last - first;
}

double worst_sigma_m(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return 0.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  const double largest = solver.eigenvalues()[2];
  return largest > 0.0 ? std::sqrt(largest) : 0.0;
}

void add_histories(const std::vector<Estimate>& estimates, ReportData& data) {
  for (const Estimate& estimate : estimates) {
    if (const auto* scale = std::get_if<ScaleEstimate>(&estimate)) {
      if (!scale->observable || !(scale->m_per_unit > 0.0) || !std::isfinite(scale->log_sigma)) continue;
      data.scale_history.push_back(
          {(scale->time - data.start).seconds(), scale->m_per_unit, scale->log_sigma, scale->segment});
    } else if (const auto* tag = std::get_if<TagEstimate>(&estimate)) {
      const double sigma = evaluate::is_located(*tag) ? worst_sigma_m(tag->covariance_m2) : 0.0;
      if (sigma > 0.0) data.sigma_history[tag->epc].push_back({(tag->time - data.start).seconds(), sigma});
    }
  }
}

// HEALTH tells the number of faults and the last of them.
void add_told_faults(const std::vector<Estimate>& estimates, ReportData& data) {
  std::uint64_t told = 0;
  for (const Estimate& estimate : estimates) {
    const auto* health = std::get_if<Health>(&estimate);
    if (health == nullptr || health->faults <= told) continue;
    told = health->faults;
    data.faults.push_back({health->time, "", health->last_fault});
  }
}

// The page has ONE world: that of the segment with the longest path.
void add_truth(const simulate::Truth& truth, ReportData& data) {
  const auto& segments = data.evaluation->trajectory.segments;
  const auto longest = std::max_element(segments.begin(), segments.end(),
                                        [](const auto& a, const auto& b) { return a.path_m < b.path_m; });
  if (longest == segments.end()) return;
  const Rigid3 T_W_truth = longest->T_truth_W.inverse();
  for (const simulate::TruePose& pose : truth.trajectory) data.truth.path.push_back(T_W_truth * pose.T_W_C.t);
  for (const simulate::TrueTag& tag : truth.tags) data.truth.tags[tag.epc] = T_W_truth * tag.p_W_X_m;
}

}  // namespace

Result<ReportData> collect(const std::vector<Estimate>& estimates, const std::optional<simulate::Truth>& truth,
                           const std::string& name) {
  ReportData data;
  data.name = name;
  data.last = evaluate::last_of(estimates);
  set_time_span(estimates, data);
  add_histories(estimates, data);
  add_told_faults(estimates, data);
  for (const auto& [epc, tag] : data.last.tags) data.tags.push_back(tag);
  std::stable_partition(data.tags.begin(), data.tags.end(), evaluate::is_located);
  if (truth) {
    auto evaluation = evaluate::evaluate(estimates, *truth);
    if (!evaluation) return evaluation.error();
    data.evaluation = std::move(evaluation).value();
    add_truth(*truth, data);
  }
  return data;
}

}  // namespace rfmvo::report
