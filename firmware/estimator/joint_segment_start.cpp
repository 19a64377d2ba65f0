// JointSegment: where it starts from.
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "estimator/electrical_length.hpp"
#include "estimator/joint_segment.hpp"

namespace rfmvo {
namespace {

constexpr double kMeanTagDistance_m = 2.0;  // part of what hops measure as electrical length
constexpr double kTypicalLength_m = 6.0;    // cable and reader: where nothing is known, better than none

}  // namespace

void JointSegment::estimate_electrical_lengths() {
  for (std::size_t p = 0; p < shared_.ports.size(); ++p) {
    constexpr double kCalibrated_m = 2.0;  // hops tell no better than that: the tags' distances are in it
    if (calibration_.antennas[p].electrical_length_sigma_m < kCalibrated_m) continue;
    std::vector<std::vector<TimedPhase>> chains;
    for (const auto& [epc, tag] : tags_) {
      std::vector<TimedPhase>& chain = chains.emplace_back();
      for (const SegmentTag::Read& r : tag.chains[p])
        chain.push_back({r.time_s, r.read.phase_rad, r.read.geometry.frequency_term_rad_m});
    }
    const ElectricalLength hops = electrical_length_from_hops(chains);
    // A length that noise made up leads the whole start astray: it looks as sure as a true one.
    constexpr double kMinSignificance = 4.0;
    shared_.ports[p].electrical_length_m =
        hops.significance > kMinSignificance ? std::max(0.0, hops.length_m - kMeanTagDistance_m) : kTypicalLength_m;
  }
}

// Nothing is left of a solution that may have been wrong, least of all how noisy the reads seemed to it.
std::vector<StartCandidate> JointSegment::search_starts(const Misreads& misreads) {
  forget_solution();
  misreads_ = misreads;
  estimate_electrical_lengths();
  std::vector<Epc> all;
  for (const auto& [epc, tag] : tags_) all.push_back(epc);
  StartOptions options;
  // The cart's mean speed bounds the scale before any read does.
  const double speed_V_s = path_.arc_V() / (path_.poses().back().time - start_time_).seconds();
  options.log_scale_min = std::log(std::max(config_.joint.scale_min_m, config_.joint.speed_min_m_s / speed_V_s));
  options.log_scale_max = std::log(std::min(config_.joint.scale_max_m, config_.joint.speed_max_m_s / speed_V_s));
  options.range_max_m = config_.joint.tag_range_max_m;
  // While the scale is open the path bends in a few places only.
  constexpr double kIntervals = 4.0;
  const double spacing_V = 1.001 * path_.arc_V() / kIntervals;
  knot_spacing_V_ = spacing_V;  // adopt() sets the spacing of the solution
  JointState state = state_for(all);
  state.knots.assign(path_.intervals(spacing_V).size() + 1, {});
  for (TagState& tag : state.tags) tag.structured_sigma_rad = config_.joint.structured_sigma_rad;
  std::vector<StartCandidate> found = find_starts(problem_for(all, 1.0), state, beams_, options);
  std::erase_if(found, [](const StartCandidate& c) { return c.evidence < 0.0; });
  return found;
}

void JointSegment::adopt(const StartCandidate& candidate) {
  std::size_t t = 0;
  for (auto& [epc, tag] : tags_) {
    tag.state = candidate.state.tags[t];
    const auto used = std::find(candidate.used.begin(), candidate.used.end(), t);
    tag.placed = used != candidate.used.end();
    if (tag.placed) {
      tag.places = candidate.places[static_cast<std::size_t>(used - candidate.used.begin())];
      tag.reads_at_places = tag.reads;
    }
    tag.modes.clear();
    tag.reads_at_modes = 0;
    ++t;
  }
  shared_ = candidate.state;
  shared_.tags.clear();
  shared_.knots.assign(1, {});
  knot_spacing_V_ = config_.joint.knot_spacing_m / std::exp(shared_.log_scale);
  covariance_ = {};
  rivals_.clear();
  started_ = true;
}

bool JointSegment::start() {
  std::size_t tags_to_start_from = 0;
  for (const auto& [epc, tag] : tags_) tags_to_start_from += tag.reads >= kMinReads ? 1 : 0;
  if (path_.arc_V() <= next_start_arc_V_ || tags_to_start_from == 0) return false;
  next_start_arc_V_ = 1.5 * path_.arc_V();  // geometric waits: the cost of all tries stays that of a few
  const std::vector<StartCandidate> found = search_starts(misreads_configured());
  if (found.empty()) return false;
  evidence_margin_ = found[0].evidence;
  for (const StartCandidate& c : found)
    if (std::abs(c.state.log_scale - found[0].state.log_scale) > kMaterialLogScale)
      evidence_margin_ = std::min(evidence_margin_, found[0].evidence - c.evidence);
  adopt(found[0]);
  return true;
}

}  // namespace rfmvo
