#include "estimator/joint_segment.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "estimator/electrical_length.hpp"
#include "estimator/phase_error_model.hpp"
#include "estimator/structured_strength.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

constexpr std::size_t kMinReads = 8;            // four unknowns and some to judge by
constexpr std::size_t kMaxReadsPerChain = 120;  // more are thinned: neighbours tell nearly the same
constexpr double kMeanTagDistance_m = 2.0;      // part of what hops measure as electrical length
constexpr double kUniqueWeight = 0.95;          // of the best mode of a tag that may shape the path
constexpr double kDecided = 6.0;                // ln likelihood ratio between two scales
constexpr double kOtherScale = 0.035;            // of ln(scale): farther apart is another scale
constexpr double kMaterialScale = 0.1;          // nearer ones compete, but leave the scale known
constexpr double kMinUHF_hz = 840e6, kMaxUHF_hz = 960e6;  // EPC Gen2, all regions

}  // namespace

JointSegment::JointSegment(const Config& config, const Calibration& calibration, std::uint32_t id, const Rigid3& T_W_C0)
    : config_(config),
      calibration_(calibration),
      id_(id),
      T_W_C0_(T_W_C0),
      path_(T_W_C0.R),
      correlation_length_m_(config.joint.correlation_length_m),
      scale_walk_per_sqrt_m_(config.joint.vo_scale_walk_per_sqrt_m),
      rotation_walk_rad_per_sqrt_m_(rad_from_deg(config.joint.vo_rotation_walk_deg_per_sqrt_m)) {
  for (const AntennaCalibration& antenna : calibration.antennas) {
    shared_.ports.push_back({0.0, 0.0, antenna.p_C_A_m});
    beams_.boresight_C.push_back(antenna.boresight_C.normalized());
  }
  shared_.knots.resize(2);
}

std::optional<int> JointSegment::port_index(std::uint8_t port) const {
  for (std::size_t i = 0; i < calibration_.antennas.size(); ++i)
    if (calibration_.antennas[i].port == port) return static_cast<int>(i);
  return std::nullopt;
}

void JointSegment::add(const CameraPose& pose) {
  if (path_.empty()) start_time_ = pose.time;
  path_.add(pose);
}

void JointSegment::add(const SampledRead& sampled) {
  const TagRead& read = sampled.read;
  const std::optional<int> port = port_index(read.port);
  const double frequency_hz = read.frequency_hz;
  if (!port || read.seen_count != 1 || frequency_hz < kMinUHF_hz || frequency_hz > kMaxUHF_hz) {
    ++rejected_;
    return;
  }
  if (reference_frequency_hz_ == 0.0) reference_frequency_hz_ = frequency_hz;
  SegmentTag& tag = tags_[read.epc];
  tag.chains.resize(calibration_.antennas.size());
  tag.state.structured_sigma_rad = tag.reads == 0 ? config_.joint.structured_sigma_rad : tag.state.structured_sigma_rad;

  SegmentTag::Read r;
  r.read.geometry = path_.geometry(sampled.T_V_C, sampled.velocity_V, sampled.angular_velocity_C);
  r.read.geometry.wavenumber_rad_m = 2.0 * kTwoPi * frequency_hz / kSpeedOfLight_m_s;
  r.read.geometry.frequency_term_rad_m = 2.0 * kTwoPi * (frequency_hz - reference_frequency_hz_) / kSpeedOfLight_m_s;
  r.read.phase_rad = read.phase.rad();
  const double odometry_rad = r.read.geometry.wavenumber_rad_m * config_.joint.vo_position_sigma_m;
  r.read.white_rad2 = std::pow(white_sigma_rad(0.01 * read.rssi_cdbm), 2) + odometry_rad * odometry_rad;
  r.read.port = *port;
  r.arc_V = path_.arc_at(read.time);
  r.time_s = (read.time - start_time_).seconds();
  r.frequency_hz = frequency_hz;
  // A late read goes where it belongs: chains are in time order.
  std::vector<SegmentTag::Read>& chain = tag.chains[static_cast<std::size_t>(*port)];
  const auto later = [](double t, const SegmentTag::Read& other) { return t < other.time_s; };
  chain.insert(std::upper_bound(chain.begin(), chain.end(), r.time_s, later), r);
  ++tag.reads;
  tag.last_read = read.time;
}

JointProblem JointSegment::problem_for(const std::vector<Epc>& epcs, double reference_scale_m) const {
  JointProblem problem;
  problem.intervals = path_.intervals(knot_spacing_V_);
  problem.reference_scale_m = reference_scale_m;
  problem.correlation_length_m = correlation_length_m_;
  problem.flip_probability = config_.joint.flip_probability;
  problem.outlier_probability = config_.joint.outlier_probability;
  JointPriors& priors = problem.priors;
  priors.time_offset_sigma_s = config_.joint.time_offset_sigma_s;
  priors.electrical_length_m = 0.0;
  priors.electrical_length_sigma_m = 40.0;
  priors.scale_walk_per_sqrt_m = scale_walk_per_sqrt_m_;
  priors.rotation_walk_rad_per_sqrt_m = rotation_walk_rad_per_sqrt_m_;
  priors.position_walk_m_per_sqrt_m = config_.joint.vo_position_walk_m_per_sqrt_m;
  for (const AntennaCalibration& antenna : calibration_.antennas) {
    priors.lever_arm_C.push_back(antenna.p_C_A_m);
    priors.lever_arm_sigma_m.push_back(std::max(antenna.lever_arm_sigma_m, 1e-4));
  }
  for (const Epc& epc : epcs) {
    std::vector<JointRead>& reads = problem.reads.emplace_back();
    for (const auto& chain : tags_.at(epc).chains) {
      const std::size_t count = std::min(chain.size(), kMaxReadsPerChain);
      for (std::size_t k = 0; k < count; ++k) {
        const SegmentTag::Read& source = chain[k * chain.size() / count];
        JointRead read = source.read;
        const KnotPlace place = path_.place(source.arc_V, knot_spacing_V_);
        read.knot = std::min(place.knot, static_cast<int>(problem.intervals.size()) - 1);
        read.knot_fraction = place.fraction;
        read.p_W_A = reference_scale_m * read.geometry.n_W +
                     read.geometry.R_W_C * calibration_.antennas[static_cast<std::size_t>(read.port)].p_C_A_m;
        reads.push_back(read);
      }
    }
  }
  return problem;
}

JointState JointSegment::state_for(const std::vector<Epc>& epcs) const {
  JointState state = shared_;
  state.tags.clear();
  for (const Epc& epc : epcs) state.tags.push_back(tags_.at(epc).state);
  return state;
}

void JointSegment::keep(const std::vector<Epc>& epcs, const JointState& state) {
  shared_ = state;
  shared_.tags.clear();
  for (std::size_t t = 0; t < epcs.size(); ++t) tags_.at(epcs[t]).state = state.tags[t];
}

// New knots start where the last one left: same drift, same correction carried on.
void JointSegment::resize_knots() {
  const std::size_t count = path_.intervals(knot_spacing_V_).size() + 1;
  while (shared_.knots.size() < count) shared_.knots.push_back(shared_.knots.back());
}

void JointSegment::estimate_electrical_lengths() {
  for (std::size_t p = 0; p < shared_.ports.size(); ++p) {
    std::vector<std::vector<TimedPhase>> chains;
    for (const auto& [epc, tag] : tags_) {
      std::vector<TimedPhase>& chain = chains.emplace_back();
      for (const SegmentTag::Read& r : tag.chains[p])
        chain.push_back({r.time_s, r.read.phase_rad, r.read.geometry.frequency_term_rad_m});
    }
    const ElectricalLength hops = electrical_length_from_hops(chains);
    constexpr double kMinCoherence = 0.2;
    if (hops.coherence > kMinCoherence)
      shared_.ports[p].electrical_length_m = std::max(0.0, hops.length_m - kMeanTagDistance_m);
  }
}

std::vector<StartCandidate> JointSegment::search_starts() {
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
  std::vector<StartCandidate> found = find_starts(problem_for(all, 1.0), state, beams_, options);
  std::erase_if(found, [](const StartCandidate& c) { return c.evidence < 0.0; });
  return found;
}

void JointSegment::adopt(const StartCandidate& candidate) {
  std::size_t t = 0;
  for (auto& [epc, tag] : tags_) {
    tag.state = candidate.state.tags[t];
    tag.placed = std::find(candidate.used.begin(), candidate.used.end(), t) != candidate.used.end();
    tag.modes.clear();
    ++t;
  }
  shared_ = candidate.state;
  shared_.tags.clear();
  shared_.knots.assign(1, {});
  knot_spacing_V_ = config_.joint.knot_spacing_m / std::exp(shared_.log_scale);
  covariance_ = {};
  started_ = true;
}

bool JointSegment::start() {
  std::size_t tags_to_start_from = 0;
  for (const auto& [epc, tag] : tags_) tags_to_start_from += tag.reads >= kMinReads ? 1 : 0;
  if (path_.arc_V() <= next_start_arc_V_ || tags_to_start_from == 0) return false;
  next_start_arc_V_ = 1.5 * path_.arc_V();  // geometric waits: the cost of all tries stays that of a few
  const std::vector<StartCandidate> found = search_starts();
  if (found.empty()) return false;
  evidence_margin_ = found[0].evidence;
  for (const StartCandidate& c : found)
    if (std::abs(c.state.log_scale - found[0].state.log_scale) > kMaterialScale)
      evidence_margin_ = std::min(evidence_margin_, found[0].evidence - c.evidence);
  adopt(found[0]);
  return true;
}

double JointSegment::total_evidence() const {
  std::vector<Epc> placed;
  for (const auto& [epc, tag] : tags_)
    if (tag.placed && tag.reads >= kMinReads) placed.push_back(epc);
  if (placed.empty()) return 0.0;
  return evidence(problem_for(placed, std::exp(shared_.log_scale)), state_for(placed));
}

// At the end: is there another scale that explains all reads as well?
void JointSegment::consider_rivals() {
  double best = total_evidence(), second = 0.0;
  constexpr double kWorthATry = 40.0;  // nats below the best start
  constexpr std::size_t kMaxRivals = 2;
  JointSegment rival = *this;
  std::size_t tried = 0;
  double first_evidence = 0.0;
  for (const StartCandidate& c : rival.search_starts()) {
    if (first_evidence == 0.0) first_evidence = c.evidence;
    if (std::abs(c.state.log_scale - shared_.log_scale) < kOtherScale) continue;
    if (tried == kMaxRivals || c.evidence < first_evidence - kWorthATry) break;
    ++tried;
    rival = *this;
    rival.adopt(c);
    rival.iterate(false);  // enough to compare; only a better one is worth the whole effort
    const auto material = [&] { return std::abs(rival.shared_.log_scale - shared_.log_scale) > kMaterialScale; };
    double e = rival.total_evidence();
    if (e > best) {
      rival.iterate(true);
      e = rival.total_evidence();
      if (material()) second = std::max(second, best);
      best = e;
      const auto revision = revision_;
      *this = rival;
      revision_ = revision;
    } else if (material()) {
      second = std::max(second, e);
    }
  }
  evidence_margin_ = best - second;
}

// Random-walk strengths of the odometry from the corrections themselves: one step of expectation
// maximisation, with the configured strength as a prior worth kPriorIntervals of path.
void JointSegment::estimate_drift() {
  const SharedLayout& layout = covariance_.layout;
  const JointProblem problem = problem_for({}, std::exp(shared_.log_scale));
  if (covariance_.shared.rows() != layout.size() || layout.knots != static_cast<int>(shared_.knots.size())) return;
  constexpr double kPriorIntervals = 8.0;
  const double nominal_scale = config_.joint.vo_scale_walk_per_sqrt_m;
  const double nominal_turn = rad_from_deg(config_.joint.vo_rotation_walk_deg_per_sqrt_m);
  double scale_sum = kPriorIntervals * nominal_scale * nominal_scale, scale_count = kPriorIntervals;
  double turn_sum = 3.0 * kPriorIntervals * nominal_turn * nominal_turn, turn_count = 3.0 * kPriorIntervals;
  const Eigen::MatrixXd& P = covariance_.shared;
  const auto second_moment = [&](int k, int offset, double change) {
    const int b = layout.knot(k + 1) + offset;
    double variance = P(b, b);
    if (k > 0) {
      const int a = layout.knot(k) + offset;
      variance += P(a, a) - 2.0 * P(a, b);
    }
    return change * change + std::max(variance, 0.0);
  };
  for (int k = 0; k + 1 < layout.knots; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double length_m = problem.reference_scale_m * problem.intervals[i].length_V;
    const KnotState& a = shared_.knots[i];
    const KnotState& b = shared_.knots[i + 1];
    scale_sum += second_moment(k, 6, b.log_scale_drift - a.log_scale_drift) / length_m;
    scale_count += 1.0;
    for (int j = 0; j < 3; ++j)
      turn_sum += second_moment(k, 3 + j, b.rotation_correction_W[j] - a.rotation_correction_W[j]) / length_m;
    turn_count += 3.0;
  }
  scale_walk_per_sqrt_m_ = std::sqrt(scale_sum / scale_count);
  rotation_walk_rad_per_sqrt_m_ = std::sqrt(turn_sum / turn_count);
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

// Modes of tags that are new, ambiguous, or (thorough) of all, given the path as it is.
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
    const SpectrumOptions options{.range_max_m = config_.joint.tag_range_max_m, .max_peaks = 16};
    constexpr std::size_t kReadsForModes = 64;
    tag.modes = effort == Effort::kRefresh && !tag.modes.empty()
                    ? refresh_modes(problem, 0, state, tag.modes)
                    : find_modes(problem, 0, state, beams_, options, true, kReadsForModes);
    tag.placed = !tag.modes.empty();
    if (!tag.placed) continue;
    weigh_with_path_uncertainty(problem, state, tag.modes);
    tag.state = tag.modes[0].tag;
    tag.covariance = tag.modes[0].covariance;
  }
}

// A mode may fit badly only because the path or a port's offset is not right yet. Each mode's cost is
// lowered by what the shared states could still give way to it, to second order: with information S
// and gradient g of the tag's reads, 1/2 g^T (P^-1 + S)^-1 g under their present covariance P.
void JointSegment::weigh_with_path_uncertainty(const JointProblem& problem, JointState state, std::vector<TagMode>& modes) const {
  const Eigen::MatrixXd& P = covariance_.shared;
  if (modes.size() < 2 || P.rows() != SharedLayout{static_cast<int>(state.ports.size()), static_cast<int>(state.knots.size())}.size()) return;
  for (TagMode& mode : modes) {
    state.tags = {mode.tag};
    const TagCoupling c = tag_coupling(problem, state);
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(P.rows(), P.cols()) + c.information * P;
    const Eigen::VectorXd give = P * A.partialPivLu().solve(c.gradient);
    mode.cost -= 0.5 * c.gradient.dot(give);
    const Eigen::MatrixXd gain = c.own_covariance * c.H_shared;
    mode.covariance += gain * P * gain.transpose();
  }
  weigh_modes(modes);
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
  place(Effort::kNew);
  refine(1);
  compute_covariance();
  estimate_drift();
  // The more tags join, the better the path and the port offsets, and the fewer modes remain.
  constexpr int kMaxRounds = 3;
  for (int round = 0; thorough && round < kMaxRounds; ++round) {
    const std::vector<Epc> before = joined_tags();
    place(round == 0 ? Effort::kAll : Effort::kRefresh);
    refine(2);
    compute_covariance();
    estimate_drift();
    if (round > 0 && joined_tags() == before) break;
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

bool JointSegment::scale_observable() const {
  return started_ && evidence_margin_ > kDecided && log_scale_sigma() < config_.joint.scale_sigma_max;
}

double JointSegment::scale_m_per_unit() const { return std::exp(shared_.log_scale); }

double JointSegment::log_scale_sigma() const {
  if (covariance_.shared.size() == 0) return 1e9;
  return std::sqrt(std::max(0.0, covariance_.shared(SharedLayout::kLogScale, SharedLayout::kLogScale)));
}

Rigid3 JointSegment::T_W_C(const PathPose& pose) const {
  const KnotPlace place = path_.place(pose.arc_V, knot_spacing_V_);
  const auto last = shared_.knots.size() - 1;
  const KnotState& a = shared_.knots[std::min(static_cast<std::size_t>(place.knot), last)];
  const KnotState& b = shared_.knots[std::min(static_cast<std::size_t>(place.knot) + 1, last)];
  const double f = place.fraction;
  const Eigen::Vector3d d = (1.0 - f) * a.path_correction_W + f * b.path_correction_W;
  const Eigen::Vector3d theta = (1.0 - f) * a.rotation_correction_W + f * b.rotation_correction_W;
  return {(so3_exp(theta) * pose.R_W_C).normalized(), T_W_C0_.t + std::exp(shared_.log_scale) * pose.n_W + d};
}

Eigen::Vector3d JointSegment::antenna_W(const SegmentTag::Read& read) const {
  const PathPose pose{{}, read.read.geometry.n_W, Eigen::Quaterniond(read.read.geometry.R_W_C), read.arc_V};
  return T_W_C(pose) * shared_.ports[static_cast<std::size_t>(read.read.port)].lever_arm_C;
}

Eigen::MatrixXd JointSegment::pose_jacobian(const PathPose& pose) const {
  const SharedLayout& layout = covariance_.layout;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, layout.size());
  J.block<3, 1>(0, SharedLayout::kLogScale) = std::exp(shared_.log_scale) * pose.n_W;
  const KnotPlace place = path_.place(pose.arc_V, knot_spacing_V_);
  for (int side = 0; side < 2; ++side) {
    const int k = std::min(place.knot + side, layout.knots - 1);
    if (k == 0) continue;
    const double w = side == 0 ? 1.0 - place.fraction : place.fraction;
    J.block<3, 3>(0, layout.knot(k)) += w * Eigen::Matrix3d::Identity();
    J.block<3, 3>(3, layout.knot(k) + 3) += w * Eigen::Matrix3d::Identity();
  }
  return J;
}

Eigen::Matrix<double, 6, 6> JointSegment::pose_covariance(const PathPose& pose) const {
  if (covariance_.shared.size() == 0) return Eigen::Matrix<double, 6, 6>::Zero();
  const Eigen::MatrixXd J = pose_jacobian(pose);
  return J * covariance_.shared * J.transpose();
}

}  // namespace rfmvo
