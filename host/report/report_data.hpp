// What the page shows, taken from the estimates and (if there is one) the truth.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/evaluation.hpp"
#include "evaluate/last_estimates.hpp"
#include "report/journal_data.hpp"

namespace rfmvo::report {

struct ScalePoint {
  double time_s = 0.0;  // since the start of the result
  double m_per_unit = 0.0;
  double log_sigma = 0.0;
  std::uint32_t segment = 0;
};

struct SigmaPoint {
  double time_s = 0.0;
  double sigma_m = 0.0;  // along the worst axis
};

struct TrueInResult {  // the truth, moved into the W of the result
  std::vector<Eigen::Vector3d> path;
  std::map<Epc, Eigen::Vector3d> tags;
};

struct ReportData {
  std::string name;
  DeviceTime start;
  Duration duration;
  evaluate::LastEstimates last;
  std::vector<TagEstimate> tags;  // located first, then by EPC: the order and the numbers of the page
  std::vector<ScalePoint> scale_history;
  std::map<Epc, std::vector<SigmaPoint>> sigma_history;
  std::optional<evaluate::Evaluation> evaluation;
  TrueInResult truth;
  std::optional<JournalData> journal;
  std::vector<Fault> faults;  // the journal's; without one, as HEALTH told of them
};

[[nodiscard]] Result<ReportData> collect(const std::vector<Estimate>& estimates,
                                         const std::optional<simulate::Truth>& truth, const std::string& name);

}  // namespace rfmvo::report
