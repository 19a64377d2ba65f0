// JointSegment: from reads and a start to a solution and its covariance.
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "estimator/joint_segment.hpp"
#include "estimator/mode_selection.hpp"
#include "estimator/structured_strength.hpp"

namespace rfmvo {
namespace {

constexpr double kLeastShare = 0.02;  // of a mode that takes part in the solution
// Scale, port offsets and path have heavier tails than the curvature at the solution says: tags change lobes on the way
// (profile of the evidence over ln(scale), S3: 3 nats down at 2.5 sigma, 5 at 3.4; docs/accuracy.md).
constexpr double kTails = 1.3;

}  // namespace

double JointSegment::total_evidence() const {
  const std::vector<Candidate> some = candidates(kLeastShare);
  if (some.empty()) return 0.0;
  double signal = 0.0;
  for (const Candidate& c : some) signal += c.share * tags_.at(c.epc).modes[c.mode].signal_cost;
  return log_marginal_likelihood(problem_for(some), state_for(some)) - signal;
}

// What a typical tag of this site is like, from those whose position the phases have decided. A few tell nothing.
void JointSegment::estimate_signal_level() {
  constexpr std::size_t kFewest = 4;
  std::vector<double> levels_db;
  for (const auto& [epc, tag] : tags_) {
    if (!tag.unique()) continue;
    const JointProblem one = problem_for(std::vector{epc}, std::exp(shared_.log_scale));
    levels_db.push_back(fit_signal_strength(one.reads[0], shared_, beams_, tag.state.p_W_X).level_db);
  }
  beams_.level_db.reset();
  if (levels_db.size() < kFewest) return;
  const auto middle = levels_db.begin() + static_cast<std::ptrdiff_t>(levels_db.size() / 2);
  std::nth_element(levels_db.begin(), middle, levels_db.end());
  beams_.level_db = *middle;
}

// Modes of tags that are new, ambiguous, or (kAll) of all, given the path as it is.
void JointSegment::place(Effort effort) {
  const double scale = std::exp(shared_.log_scale);
  for (auto& [epc, tag] : tags_) {
    std::size_t reads = 0;
    for (const auto& chain : tag.chains) reads += chain.size();
    if (reads < kMinReads) continue;
    // Looked at again when a third more reads have come.
    if (effort == Effort::kNew && (tag.unique() || 3 * reads < 4 * tag.reads_at_modes)) continue;
    tag.reads_at_modes = reads;
    const JointProblem problem = problem_for(std::vector{epc}, scale);
    const JointState state = state_for(std::vector{epc});
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
    if (tag.placed) tag.state = tag.modes[0].tag;
  }
}

// The modes of each tag weighed by how they suit the reads of all the others.
void JointSegment::select() {
  if (covariance_.information.rows() != layout().size()) return;
  const double scale = std::exp(shared_.log_scale);
  for (auto& [epc, tag] : tags_) {
    if (tag.modes.size() < 2) continue;
    const JointProblem one = problem_for(std::vector{epc}, scale);
    const JointState state = state_for(std::vector{epc});
    OtherReads others{covariance_.information, Eigen::VectorXd::Zero(layout().size())};
    JointState at = state;
    for (const SegmentTag::Part& part : tag.parts) {
      at.tags = {part.tag};
      take_out(tag_coupling(one, at), part.share, others);
    }
    select_modes(one, state, others, tag.modes);
    tag.state = tag.modes[0].tag;
  }
}

// Strengths from the tags whose position is decided; the others are judged with what these show.
void JointSegment::estimate_noise(const std::vector<Candidate>& some, bool shape, JointProblem& problem,
                                  JointState& state) {
  const StrengthOptions strength{.floor_rad = config_.joint.structured_sigma_floor_rad,
                                 .prior_rad = config_.joint.structured_sigma_rad};
  std::vector<Candidate> decided = some;
  std::erase_if(decided, [](const Candidate& c) { return c.share < SegmentTag::kUniqueWeight; });
  if (decided.empty()) {
    decided = some;
    std::erase_if(decided, [](const Candidate& c) { return c.mode != 0; });
  }
  for (Candidate& c : decided) c.share = 1.0;
  JointProblem known = problem_for(decided);
  JointState of_known = state;
  of_known.tags.clear();
  std::size_t k = 0;
  for (std::size_t i = 0; i < some.size(); ++i)
    if (k < decided.size() && some[i].epc == decided[k].epc && some[i].mode == decided[k].mode) {
      of_known.tags.push_back(state.tags[i]);
      ++k;
    }
  if (shape)
    structured_.fade_exponent = known.structured.fade_exponent = estimate_fade_exponent(known, of_known, strength);
  estimate_structured_strength(known, strength, of_known);
  if (shape) {
    misreads_ = estimate_misreads(known, of_known, misreads_configured());
    problem.flip_probability = misreads_.flips;
    problem.outlier_probability = misreads_.outliers;
    structured_ = estimate_correlation(known, of_known, config_.joint.correlation_length_m);
  }
  problem.structured = structured_;
  double typical = 0.0;
  for (const TagState& t : of_known.tags) typical += t.structured_sigma_rad / static_cast<double>(of_known.tags.size());
  for (auto& [epc, tag] : tags_) {
    const auto found =
        std::find_if(decided.begin(), decided.end(), [&epc = epc](const Candidate& c) { return c.epc == epc; });
    const double sigma = found == decided.end()
                             ? typical
                             : of_known.tags[static_cast<std::size_t>(found - decided.begin())].structured_sigma_rad;
    tag.state.structured_sigma_rad = sigma;
    for (TagMode& mode : tag.modes) mode.tag.structured_sigma_rad = sigma;
  }
  for (std::size_t i = 0; i < some.size(); ++i)
    state.tags[i].structured_sigma_rad = tags_.at(some[i].epc).state.structured_sigma_rad;
}

// One step of expectation maximisation: the path and all positions, each mode counting as much as it is likely.
void JointSegment::refine(bool shape) {
  const std::vector<Candidate> some = candidates(kLeastShare);
  if (some.empty()) return;
  JointProblem problem = problem_for(some);
  JointState state = state_for(some);
  (void)rfmvo::solve(problem, {.max_iterations = 10}, state);
  estimate_noise(some, shape, problem, state);
  (void)rfmvo::solve(problem, {.max_iterations = 10}, state);
  keep(some, state);
}

// Over all undecided tags: the covariance of what a tag's modes pull the shared states to.
Eigen::MatrixXd JointSegment::missing_information() const {
  Eigen::MatrixXd missing;
  const double scale = std::exp(shared_.log_scale);
  for (const auto& [epc, tag] : tags_) {
    if (tag.modes.size() < 2 || tag.unique()) continue;
    const JointProblem one = problem_for(std::vector{epc}, scale);
    JointState state = state_for(std::vector{epc});
    if (missing.size() == 0) missing = Eigen::MatrixXd::Zero(layout().size(), layout().size());
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(layout().size());
    for (const TagMode& mode : tag.modes) {
      if (mode.weight < kLeastShare) continue;
      state.tags = {mode.tag};
      const Eigen::VectorXd pull = tag_coupling(one, state).gradient;
      missing += mode.weight * pull * pull.transpose();
      mean += mode.weight * pull;
    }
    missing -= mean * mean.transpose();
  }
  return missing;
}

void JointSegment::compute_covariance() {
  const std::vector<Candidate> some = candidates(kLeastShare);
  if (some.empty()) return;
  covariance_ = covariance(problem_for(some), state_for(some), missing_information(), kTails);
  for (auto& [epc, tag] : tags_) tag.parts.clear();
  for (std::size_t i = 0; i < some.size(); ++i) {
    SegmentTag& tag = tags_.at(some[i].epc);
    tag.parts.push_back({tag.modes[some[i].mode].tag, some[i].share});
    tag.modes[some[i].mode].covariance = covariance_.tag[i];
    if (some[i].mode > 0) continue;
    tag.covariance = covariance_.tag[i];
    tag.shared_covariance = covariance_.tag_shared[i];
  }
}

void JointSegment::iterate(Depth depth) {
  resize_knots();
  estimate_signal_level();
  place(depth == Depth::kLook ? Effort::kNew : Effort::kAll);
  // The more tags are decided, the better the path and the port offsets, and the fewer modes remain.
  const int rounds = depth == Depth::kLook ? 1 : depth == Depth::kAside ? 2 : 4;
  for (int round = 0; round < rounds; ++round) {
    if (round > 0) {
      estimate_signal_level();
      place(Effort::kRefresh);
    }
    select();
    refine(depth == Depth::kFull && round < 3);
    if (depth == Depth::kFull && round > 0) estimate_drift();
    compute_covariance();
  }
}

void JointSegment::solve(bool thorough) {
  if (path_.poses().size() < 2 || path_.arc_V() <= 0.0 || tags_.empty()) return;
  if (thorough) next_start_arc_V_ = 0.0;
  if (!started_ && !start()) return;
  iterate(thorough ? Depth::kFull : Depth::kLook);
  if (thorough) consider_rivals();
  ++revision_;
  // A solution that the reads do not support, or whose scale is undecided, is searched for again.
  const bool believable = total_evidence() > 0.0;
  if (!thorough && (!believable || !scale_observable())) started_ = false;
}

}  // namespace rfmvo
