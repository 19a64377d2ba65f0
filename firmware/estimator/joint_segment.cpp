#include "estimator/joint_segment.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/units.hpp"
#include "estimator/phase_error_model.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

constexpr std::size_t kMaxReadsPerChain = 120;  // more are thinned: neighbours tell nearly the same
constexpr std::size_t kMaxStoredPerChain = 4 * kMaxReadsPerChain;
// A solution that calls this many reads garbled explains too little to be believed: at 30 % true outliers it was wrong
// in one tag of eight that it claimed.
constexpr double kMostOutliers = 0.15;
constexpr double kDecided = 6.0;                          // ln likelihood ratio between two scales
constexpr double kStrongShare = 0.1;                      // of a tag's reads: those that count as strong
constexpr double kMinUHF_hz = 840e6, kMaxUHF_hz = 960e6;  // EPC Gen2, all regions

// Power that a tag's strong reads exceed, dBm.
double strong_rssi_db(const SegmentTag& tag) {
  std::vector<double> rssi_db;
  for (const auto& chain : tag.chains)
    for (const SegmentTag::Read& r : chain) rssi_db.push_back(r.read.rssi_db);
  const auto rank = static_cast<std::ptrdiff_t>(kStrongShare * static_cast<double>(rssi_db.size()));
  std::nth_element(rssi_db.begin(), rssi_db.begin() + rank, rssi_db.end(), std::greater<>());
  return rssi_db[static_cast<std::size_t>(rank)];
}

}  // namespace

JointSegment::JointSegment(const Config& config, const Calibration& calibration, std::uint32_t id, const Rigid3& T_W_C0)
    : config_(config),
      calibration_(calibration),
      ids_{id},
      anchor_{{Eigen::Quaterniond::Identity(), T_W_C0.t}},
      path_(T_W_C0.R) {
  for (const AntennaCalibration& antenna : calibration.antennas)
    beams_.boresight_C.push_back(antenna.boresight_C.normalized());
  beams_.range_max_m = config.joint.tag_range_max_m;
  forget_solution();
}

void JointSegment::forget_solution() {
  set_drift(1.0);
  structured_ = {.length_m = config_.joint.correlation_length_m};
  misreads_ = misreads_configured();
  shared_ = {};
  for (const AntennaCalibration& antenna : calibration_.antennas)
    shared_.ports.push_back({0.0, antenna.electrical_length_m, antenna.p_C_A_m});
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
  const auto piece = static_cast<std::size_t>(std::find(ids_.begin(), ids_.end(), sampled.segment) - ids_.begin());
  r.read.geometry = path_.geometry(sampled.T_V_C, sampled.velocity_V, sampled.angular_velocity_C, piece);
  r.read.geometry.wavenumber_rad_m = wavenumber_rad_m(frequency_hz);
  r.read.geometry.frequency_term_rad_m = wavenumber_rad_m(frequency_hz - reference_frequency_hz_);
  r.read.phase_rad = read.phase.rad();
  const double odometry_rad = r.read.geometry.wavenumber_rad_m * config_.joint.vo_position_sigma_m;
  r.read.white_rad2 = std::pow(white_sigma_rad(0.01 * read.rssi_cdbm), 2) + odometry_rad * odometry_rad;
  r.read.port = *port;
  r.read.rssi_db = 0.01 * read.rssi_cdbm;
  r.arc_V = path_.arc_at(read.time);
  r.time_s = (read.time - start_time_).seconds();
  r.frequency_hz = frequency_hz;
  // A late read goes where it belongs: chains are in time order.
  std::vector<SegmentTag::Read>& chain = tag.chains[static_cast<std::size_t>(*port)];
  const auto later = [](double t, const SegmentTag::Read& other) { return t < other.time_s; };
  chain.insert(std::upper_bound(chain.begin(), chain.end(), r.time_s, later), r);
  // Memory has an end, a standstill may have none: every other read goes.
  if (chain.size() >= kMaxStoredPerChain) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < chain.size(); i += 2) chain[kept++] = chain[i];
    chain.resize(kept);
  }
  ++tag.reads;
  tag.last_read = read.time;
}

JointProblem JointSegment::problem_for(const std::vector<Epc>& epcs, double reference_scale_m) const {
  JointProblem problem;
  problem.intervals = path_.intervals(knot_spacing_V_);
  problem.reference_scale_m = reference_scale_m;
  problem.structured = structured_;
  problem.flip_probability = misreads_.flips;
  problem.outlier_probability = misreads_.outliers;
  JointPriors& priors = problem.priors;
  priors.time_offset_sigma_s = config_.joint.time_offset_sigma_s;
  priors.scale_walk_per_sqrt_m = scale_walk_per_sqrt_m_;
  priors.rotation_walk_rad_per_sqrt_m = rotation_walk_rad_per_sqrt_m_;
  priors.position_walk_m_per_sqrt_m = position_walk_m_per_sqrt_m_;
  priors.lever_arms_common_sigma_m = calibration_.camera_sigma_m;
  for (const AntennaCalibration& antenna : calibration_.antennas) {
    priors.lever_arm_C.push_back(antenna.p_C_A_m);
    constexpr double kLeastSigma_m = 1e-4;
    priors.lever_arm_sigma_m.push_back(antenna.lever_arm_sigma_m.cwiseMax(kLeastSigma_m));
    priors.electrical_length_m.push_back(antenna.electrical_length_m);
    priors.electrical_length_sigma_m.push_back(std::max(antenna.electrical_length_sigma_m, kLeastSigma_m));
  }
  for (const Epc& epc : epcs) {
    std::vector<JointRead>& reads = problem.reads.emplace_back();
    const double strong_db = strong_rssi_db(tags_.at(epc));
    for (const auto& chain : tags_.at(epc).chains) {
      const std::size_t count = std::min(chain.size(), kMaxReadsPerChain);
      for (std::size_t k = 0; k < count; ++k) {
        const SegmentTag::Read& source = chain[k * chain.size() / count];
        JointRead read = source.read;
        const KnotPlace place = path_.place(source.arc_V, knot_spacing_V_);
        read.knot = std::min(place.knot, static_cast<int>(problem.intervals.size()) - 1);
        read.knot_fraction = place.fraction;
        read.fade_db = std::max(0.0, strong_db - read.rssi_db);
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

std::vector<Candidate> JointSegment::candidates(double least_share) const {
  std::vector<Candidate> some;
  for (const auto& [epc, tag] : tags_)
    for (std::size_t m = 0; m < tag.modes.size(); ++m)
      if (m == 0 || tag.modes[m].weight >= least_share) some.push_back({epc, m, tag.modes[m].weight});
  return some;
}

JointProblem JointSegment::problem_for(const std::vector<Candidate>& some) const {
  std::vector<Epc> epcs;
  for (const Candidate& c : some) epcs.push_back(c.epc);
  JointProblem problem = problem_for(epcs, std::exp(shared_.log_scale));
  for (const Candidate& c : some) problem.share.push_back(c.share);
  return problem;
}

JointState JointSegment::state_for(const std::vector<Candidate>& some) const {
  JointState state = shared_;
  state.tags.clear();
  for (const Candidate& c : some) state.tags.push_back(tags_.at(c.epc).modes[c.mode].tag);
  return state;
}

void JointSegment::keep(const std::vector<Candidate>& some, const JointState& state) {
  shared_ = state;
  shared_.tags.clear();
  for (std::size_t i = 0; i < some.size(); ++i) {
    SegmentTag& tag = tags_.at(some[i].epc);
    tag.modes[some[i].mode].tag = state.tags[i];
    if (some[i].mode == 0) tag.state = state.tags[i];
  }
}

// New knots start where the last one left: same drift, same correction carried on.
void JointSegment::resize_knots() {
  const std::size_t count = path_.intervals(knot_spacing_V_).size() + 1;
  while (shared_.knots.size() < count) shared_.knots.push_back(shared_.knots.back());
}

bool JointSegment::scale_observable() const {
  return started_ && evidence_margin_ > kDecided && misreads_.outliers < kMostOutliers &&
         log_scale_sigma() < config_.joint.scale_sigma_max;
}

double JointSegment::scale_m_per_unit(std::size_t piece) const {
  const PathPiece& p = path_.pieces().at(piece);
  return std::exp(shared_.log_scale) * p.joint.ratio * (1.0 + knot_at(p.arc_V).log_scale_drift);
}

double JointSegment::log_scale_sigma(std::size_t piece) const {
  if (covariance_.shared.size() == 0) return 1e9;
  Eigen::VectorXd J = Eigen::VectorXd::Zero(covariance_.layout.size());
  J[SharedLayout::kLogScale] = 1.0;
  const int knot = path_.place(path_.pieces().at(piece).arc_V, knot_spacing_V_).knot;
  constexpr int kDrift = 6;
  if (knot > 0 && knot < covariance_.layout.knots) J[covariance_.layout.knot(knot) + kDrift] = 1.0;
  double variance = J.dot(covariance_.shared * J);
  const std::vector<double> probability = weights();
  const double scale = scale_m_per_unit(piece);
  for (std::size_t r = 0; r < rivals_.size(); ++r)
    variance += probability[r + 1] * std::pow(std::log(rivals_[r].scale_m_per_unit(piece) / scale), 2);
  return std::sqrt(std::max(0.0, variance));
}

KnotState JointSegment::knot_at(double arc_V) const {
  const KnotPlace place = path_.place(arc_V, knot_spacing_V_);
  const auto last = shared_.knots.size() - 1;
  const KnotState& a = shared_.knots[std::min(static_cast<std::size_t>(place.knot), last)];
  const KnotState& b = shared_.knots[std::min(static_cast<std::size_t>(place.knot) + 1, last)];
  const double f = place.fraction;
  return {(1.0 - f) * a.path_correction_W + f * b.path_correction_W,
          (1.0 - f) * a.rotation_correction_W + f * b.rotation_correction_W,
          (1.0 - f) * a.log_scale_drift + f * b.log_scale_drift};
}

Rigid3 JointSegment::T_L_C(const PathPose& pose) const {
  const KnotState knot = knot_at(pose.arc_V);
  return {(so3_exp(knot.rotation_correction_W) * pose.R_W_C).normalized(),
          std::exp(shared_.log_scale) * pose.n_W + knot.path_correction_W};
}

Eigen::Vector3d JointSegment::antenna_L(const SegmentTag::Read& read) const {
  const PathPose pose{{}, read.read.geometry.n_W, Eigen::Quaterniond(read.read.geometry.R_W_C), read.arc_V};
  return T_L_C(pose) * shared_.ports[static_cast<std::size_t>(read.read.port)].lever_arm_C;
}

// A pose depends on the scale and on two knots only: (d, theta) of each.
JointSegment::PoseColumns JointSegment::pose_columns(const PathPose& pose) const {
  const SharedLayout& layout = covariance_.layout;
  PoseColumns c;
  c.J.setZero();
  c.J.topLeftCorner<3, 1>() = std::exp(shared_.log_scale) * pose.n_W;
  c.column[0] = SharedLayout::kLogScale;
  const KnotPlace place = path_.place(pose.arc_V, knot_spacing_V_);
  for (int side = 0; side < 2; ++side) {
    const int k = std::min(place.knot + side, layout.knots - 1), first = 1 + 6 * side;
    for (int i = 0; i < 6; ++i) c.column[static_cast<std::size_t>(first + i)] = k == 0 ? 0 : layout.knot(k) + i;
    if (k == 0) continue;  // the frame's origin
    const double w = side == 0 ? 1.0 - place.fraction : place.fraction;
    c.J.block<6, 6>(0, first) = w * Eigen::Matrix<double, 6, 6>::Identity();
  }
  return c;
}

Eigen::MatrixXd JointSegment::pose_jacobian(const PathPose& pose) const {
  const PoseColumns c = pose_columns(pose);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, covariance_.layout.size());
  for (std::size_t i = 0; i < c.column.size(); ++i) J.col(c.column[i]) += c.J.col(static_cast<Eigen::Index>(i));
  return J;
}

Eigen::Matrix<double, 6, 6> JointSegment::pose_covariance_L(const PathPose& pose) const {
  if (covariance_.shared.size() == 0) return Eigen::Matrix<double, 6, 6>::Zero();
  const PoseColumns c = pose_columns(pose);
  Eigen::Matrix<double, 13, 13> P;
  for (Eigen::Index i = 0; i < 13; ++i)
    for (Eigen::Index j = 0; j < 13; ++j)
      P(i, j) = covariance_.shared(c.column[static_cast<std::size_t>(i)], c.column[static_cast<std::size_t>(j)]);
  return c.J * P * c.J.transpose();
}

Eigen::Matrix<double, 6, 6> JointSegment::pose_covariance_W(const PathPose& pose) const {
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero(), J = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = anchor_.T_W_L.R.toRotationMatrix();
  J.topRows<3>() = anchor_.jacobian_at(T_W_C(pose).t);
  J.bottomRightCorner<3, 3>().setIdentity();
  return turn * pose_covariance_L(pose) * turn.transpose() + J * anchor_.covariance * J.transpose();
}

Eigen::Matrix<double, 3, 6> Anchor::jacobian_at(const Eigen::Vector3d& p_W) const {
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -skew(p_W - T_W_L.t);
  return J;
}

}  // namespace rfmvo
