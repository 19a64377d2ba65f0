// JointSegment: from reads and a start to a solution and its covariance.
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "estimator/joint_segment.hpp"
#include "estimator/mode_selection.hpp"
#include "estimator/structured_strength.hpp"

namespace rfmvo {
namespace {

constexpr double kUniqueWeight = 0.95;  // of the best mode of a tag that may shape the path

}  // namespace

double JointSegment::total_evidence() const {
  std::vector<Epc> placed;
  for (const auto& [epc, tag] : tags_)
    if (tag.placed && tag.reads >= kMinReads) placed.push_back(epc);
  if (placed.empty()) return 0.0;
  return evidence(problem_for(placed, std::exp(shared_.log_scale)), state_for(placed));
}

std::vector<Epc> JointSegment::joined_tags() const {
  std::vector<Epc> epcs;
  for (const auto& [epc, tag] : tags_)
    if (tag.placed && !tag.modes.empty() && tag.modes[0].weight >= kUniqueWeight) epcs.push_back(epc);
  // While nothing is unique, all that is placed must do.
  if (epcs.empty())
    for (const auto& [epc, tag] : tags_)
      if (tag.placed) epcs.push_back(epc);
  return epcs;
}

// Modes of tags that are new, ambiguous, or (kAll) of all, given the path as it is.
void JointSegment::place(Effort effort) {
  const double scale = std::exp(shared_.log_scale);
  for (auto& [epc, tag] : tags_) {
    std::size_t reads = 0;
    for (const auto& chain : tag.chains) reads += chain.size();
    if (reads < kMinReads) continue;
    const bool unique = tag.placed && !tag.modes.empty() && tag.modes[0].weight >= kUniqueWeight;
    // Looked at again when a third more reads have come.
    if (effort == Effort::kNew && (unique || 3 * reads < 4 * tag.reads_at_modes)) continue;
    tag.reads_at_modes = reads;
    const JointProblem problem = problem_for({epc}, scale);
    const JointState state = state_for({epc});
    if (effort == Effort::kRefresh && !tag.modes.empty()) {
      tag.modes = refresh_modes(problem, 0, state, beams_, tag.modes);
    } else {
      constexpr double kSameGrid = 0.03;  // of ln(scale)
      if (3 * reads >= 4 * tag.reads_at_places || std::abs(tag.places.log_scale - shared_.log_scale) > kSameGrid) {
        tag.places = search_places(problem.reads[0], state, beams_, {.range_max_m = config_.joint.tag_range_max_m});
        tag.reads_at_places = reads;
      }
      std::vector<Eigen::Vector3d> places = tag.places.at(shared_.log_scale);
      for (const TagMode& mode : tag.modes) places.push_back(mode.tag.p_W_X);
      constexpr std::size_t kModes = 16;
      tag.modes = find_modes(problem, 0, state, beams_, places, kModes);
    }
    tag.placed = !tag.modes.empty();
  }
}

// Each placed tag at the mode that suits the reads of all the others best.
void JointSegment::select() {
  const double scale = std::exp(shared_.log_scale);
  for (auto& [epc, tag] : tags_) {
    if (tag.modes.empty()) continue;
    const JointProblem one = problem_for({epc}, scale);
    const JointState state = state_for({epc});
    if (covariance_.information.rows() == layout().size()) {
      const TagCoupling own = tag_coupling(one, state);
      select_modes(one, state, without(covariance_.information, tag.joined ? &own : nullptr), tag.modes);
    }
    tag.state = tag.modes[0].tag;
    tag.covariance = tag.modes[0].covariance;
  }
}

void JointSegment::refine(int rounds) {
  const std::vector<Epc> epcs = joined_tags();
  if (epcs.empty()) return;
  JointProblem problem = problem_for(epcs, std::exp(shared_.log_scale));
  JointState state = state_for(epcs);
  const StrengthOptions strength{.floor_rad = config_.joint.structured_sigma_floor_rad,
                                 .prior_rad = config_.joint.structured_sigma_rad};
  for (int round = 0; round < rounds; ++round) {
    (void)rfmvo::solve(problem, {.max_iterations = 10}, state);
    estimate_structured_strength(problem, strength, state);
    if (rounds > 1)
      correlation_length_m_ = problem.correlation_length_m =
          estimate_correlation_length(problem, state, config_.joint.correlation_length_m);
  }
  (void)rfmvo::solve(problem, {.max_iterations = 10}, state);
  for (auto& [epc, tag] : tags_) tag.joined = false;
  keep(epcs, state);
  // Tags that were not joined are judged with the strength that the joined ones show.
  double typical = 0.0;
  for (const TagState& t : state.tags) typical += t.structured_sigma_rad / static_cast<double>(state.tags.size());
  for (const Epc& epc : epcs) tags_.at(epc).joined = true;
  for (auto& [epc, tag] : tags_)
    if (!tag.joined) tag.state.structured_sigma_rad = typical;
}

void JointSegment::compute_covariance() {
  const std::vector<Epc> joined = joined_tags();
  if (joined.empty()) return;
  covariance_ = covariance(problem_for(joined, std::exp(shared_.log_scale)), state_for(joined));
  for (std::size_t t = 0; t < joined.size(); ++t) {
    SegmentTag& tag = tags_.at(joined[t]);
    tag.covariance = covariance_.tag[t];
    tag.shared_covariance = covariance_.tag_shared[t];
  }
  // A tag that stood aside: its own reads given the path, and the path's uncertainty through them.
  for (auto& [epc, tag] : tags_) {
    if (!tag.placed || tag.joined) continue;
    const TagCoupling c = tag_coupling(problem_for({epc}, std::exp(shared_.log_scale)), state_for({epc}));
    const Eigen::MatrixXd gain = c.own_covariance * c.H_shared;
    tag.shared_covariance = -gain * covariance_.shared;
    tag.covariance = c.own_covariance - tag.shared_covariance * gain.transpose();
  }
}

void JointSegment::iterate(bool thorough) {
  resize_knots();
  place(thorough ? Effort::kAll : Effort::kNew);
  // The more tags join, the better the path and the port offsets, and the fewer modes remain.
  const int rounds = thorough ? 4 : 1;
  for (int round = 0; round < rounds; ++round) {
    if (round > 0) place(Effort::kRefresh);
    select();
    refine(thorough ? 2 : 1);
    if (thorough && round > 0) estimate_drift();
    compute_covariance();
  }
}

void JointSegment::solve(bool thorough) {
  if (path_.poses().size() < 2 || path_.arc_V() <= 0.0 || tags_.empty()) return;
  if (thorough) next_start_arc_V_ = 0.0;
  if (!started_ && !start()) return;
  iterate(thorough);
  if (thorough) consider_rivals();
  ++revision_;
  // A solution that the reads do not support, or whose scale is undecided, is searched for again.
  const bool believable = total_evidence() > 0.0;
  if (!thorough && (!believable || !scale_observable())) started_ = false;
}

}  // namespace rfmvo
