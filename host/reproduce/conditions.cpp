#include "reproduce/conditions.hpp"

#include <algorithm>

#include "evaluate/evaluation.hpp"
#include "reproduce/paper_run.hpp"

namespace rfmvo::reproduce {
namespace {

struct Ease {
  const char* name;
  bool no_drift, no_structured_error, one_tag;
};
constexpr Ease kEases[] = {
    {"as it is: 0.3 rad of structured phase error, drift, eight tags", false, false, false},
    {"odometry without error", true, false, false},
    {"no structured phase error", false, true, false},
    {"neither", true, true, false},
    {"one tag alone: 35 reads/s per antenna, so L = 60 is half a metre", false, false, true},
    {"one tag, odometry without error, no structured phase error", true, true, true},
};

}  // namespace

std::vector<Condition> empty_conditions() {
  std::vector<Condition> conditions;
  for (const Ease& ease : kEases) conditions.push_back({.name = ease.name, .tags = 0, .paper = {}, .repaired = {}});
  return conditions;
}

simulate::Options simulation_of(std::size_t n, const simulate::Options& wall) {
  const Ease& ease = kEases[n];
  simulate::Options options = wall;
  if (ease.no_drift) options.vo_class = "PERFECT";
  if (ease.no_structured_error) options.structured_rad = 0.0;
  if (ease.one_tag) options.tags = 1;
  return options;
}

void ConditionRuns::add(const PaperRun& run, Side& side) {
  for (const auto& error_m : run.error_m)
    if (error_m) side.tags_m.push_back(*error_m);
  for (const ScaleError& error : run.scale) side.scales.push_back(error.relative);
}

void ConditionRuns::add(const montecarlo::Recording& recording, const Config& paper) {
  Config repaired = paper;
  repair(repaired.paper);
  tags_ += recording.truth.tags.size();
  add(run_paper(recording, paper), paper_);
  add(run_paper(recording, repaired), repaired_);
}

void ConditionRuns::finish(const Side& side, Condition::Side& result) {
  result.located = side.tags_m.size();
  result.good = static_cast<std::size_t>(
      std::count_if(side.tags_m.begin(), side.tags_m.end(), [](double e) { return e <= kGood_m; }));
  if (const auto s = evaluate::summarise(side.tags_m)) result.tag_error_median_m = s->median;
  if (const auto s = evaluate::summarise(side.scales)) result.scale_relative_median = s->median;
}

void ConditionRuns::finish(Condition& condition) const {
  condition.tags = tags_;
  finish(paper_, condition.paper);
  finish(repaired_, condition.repaired);
}

}  // namespace rfmvo::reproduce
