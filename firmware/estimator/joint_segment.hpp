// One odometry segment of the joint estimator, or several that were joined: reads, path, states and their solution.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "config/calibration.hpp"
#include "config/config.hpp"
#include "estimator/joint_problem.hpp"
#include "estimator/joint_solver.hpp"
#include "estimator/joint_start.hpp"
#include "estimator/odometry_path.hpp"
#include "estimator/sampling_synchronization.hpp"
#include "estimator/segment_alignment.hpp"
#include "estimator/structured_strength.hpp"
#include "estimator/tag_modes.hpp"
#include "rf/epc.hpp"

namespace rfmvo {

struct SegmentTag {
  struct Read {
    JointRead read;  // without knot and reference position, which depend on the scale
    double arc_V = 0.0;
    double time_s = 0.0;  // since the segment's start
    double frequency_hz = 0.0;
  };
  std::vector<std::vector<Read>> chains;  // per port, in time order
  std::uint32_t reads = 0;
  DeviceTime last_read;

  TagState state;
  std::vector<TagMode> modes;      // best first
  std::size_t reads_at_modes = 0;  // when they were looked for
  struct Part {
    TagState tag;
    double share = 1.0;
  };
  std::vector<Part> parts;  // as which it took part in the newest solution
  PossiblePlaces places;
  std::size_t reads_at_places = 0;  // when they were searched
  bool placed = false;              // state holds a position
  [[nodiscard]] bool unique() const { return placed && !modes.empty() && modes[0].weight >= kUniqueWeight; }
  static constexpr double kUniqueWeight = 0.95;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  Eigen::MatrixXd shared_covariance;  // 4 x shared states
};

// One mode of a tag as an entry of the joint problem, and how much it counts there.
struct Candidate {
  Epc epc;
  std::size_t mode = 0;
  double share = 1.0;
};

// Where a segment's own frame L lies: position (m) and rotation (rad) in W are off by errors of this covariance.
struct Anchor {
  Rigid3 T_W_L;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  // What that does to a point: it moves by dt + dtheta x (p_W - t).
  [[nodiscard]] Eigen::Matrix<double, 3, 6> jacobian_at(const Eigen::Vector3d& p_W) const;
};

class JointSegment {
 public:
  enum class Depth { kLook, kAside, kFull };  // one round; two with noise and drift as they are; four with all

  JointSegment(const Config& config, const Calibration& calibration, std::uint32_t id, const Rigid3& T_W_C0);

  void add(const CameraPose& pose);
  void add(const SampledRead& read);

  // A new solution from all reads so far. `thorough` looks for all modes of all tags again.
  void solve(bool thorough);

  // This segment and a later one as one problem; nothing if the reads speak against it or do not say how they lie.
  [[nodiscard]] std::optional<JointSegment> joined(const JointSegment& later, Depth depth) const;

  // The same odometry from the next pose on; later it takes over with what this segment knows of scale and ports.
  [[nodiscard]] JointSegment following() const;
  void take_over(const JointSegment& before);
  // A segment that begins with `first`, the odometry having been lost: where it lies is guessed, its anchor says how
  // well.
  [[nodiscard]] JointSegment after_loss(const CameraPose& first) const;

  // Of the odometry, one for each piece of the path.
  [[nodiscard]] const std::vector<std::uint32_t>& ids() const { return ids_; }
  [[nodiscard]] std::uint32_t id_of(const PathPose& pose) const { return ids_[path_.piece_of(pose.arc_V)]; }
  [[nodiscard]] const std::map<Epc, SegmentTag>& tags() const { return tags_; }
  [[nodiscard]] const OdometryPath& path() const { return path_; }
  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] bool scale_observable() const;
  // Of the odometry's unit at the start of a piece, m; and the sigma of its logarithm.
  [[nodiscard]] double scale_m_per_unit(std::size_t piece = 0) const;
  [[nodiscard]] double log_scale_sigma(std::size_t piece = 0) const;
  [[nodiscard]] double length_m() const { return scale_m_per_unit() * path_.arc_V(); }
  [[nodiscard]] std::uint32_t revision() const { return revision_; }
  [[nodiscard]] std::uint64_t reads_rejected() const { return rejected_; }

  // All is solved in L: axes of W and the place of the first pose as they were believed when the segment began. Where L
  // lies in W is another matter: segments before this one may still move, and their drift does not spoil what this
  // one knows about its own tags.
  [[nodiscard]] Rigid3 T_L_C(const PathPose& pose) const;  // with the newest corrections
  [[nodiscard]] Eigen::Vector3d antenna_L(const SegmentTag::Read& read) const;
  [[nodiscard]] Eigen::Matrix<double, 6, 6> pose_covariance_L(const PathPose& pose) const;
  [[nodiscard]] const Anchor& anchor() const { return anchor_; }
  void set_anchor(const Anchor& anchor) { anchor_ = anchor; }
  [[nodiscard]] Rigid3 T_W_C(const PathPose& pose) const { return anchor_.T_W_L * T_L_C(pose); }
  [[nodiscard]] Eigen::Matrix<double, 6, 6> pose_covariance_W(const PathPose& pose) const;
  // d (position, rotation) of the camera / d shared states, at a place of the path; 6 x shared.
  [[nodiscard]] Eigen::MatrixXd pose_jacobian(const PathPose& pose) const;
  [[nodiscard]] const JointCovariance& shared_covariance() const { return covariance_; }

  // Other solutions of the same reads, and the probabilities of this one (first) and of them.
  [[nodiscard]] const std::vector<JointSegment>& rivals() const { return rivals_; }
  [[nodiscard]] std::vector<double> weights() const;

 private:
  static constexpr double kMaterialLogScale = 0.1;  // scales nearer than that compete, but leave the scale known
  static constexpr std::size_t kMinReads = 8;       // of a tag that is located: four unknowns and some to judge by

  [[nodiscard]] std::optional<int> port_index(std::uint8_t port) const;
  [[nodiscard]] JointProblem problem_for(const std::vector<Epc>& epcs, double reference_scale_m) const;
  [[nodiscard]] JointState state_for(const std::vector<Epc>& epcs) const;
  // Modes that hold at least this share of their tag.
  [[nodiscard]] std::vector<Candidate> candidates(double least_share) const;
  [[nodiscard]] JointProblem problem_for(const std::vector<Candidate>& some) const;  // at the scale as it is
  [[nodiscard]] JointState state_for(const std::vector<Candidate>& some) const;
  void keep(const std::vector<Candidate>& some, const JointState& state);
  void resize_knots();
  struct PoseColumns {
    Eigen::Matrix<double, 6, 13> J;  // d (position, rotation) / d states
    std::array<int, 13> column{};    // of these among the shared states
  };
  [[nodiscard]] PoseColumns pose_columns(const PathPose& pose) const;
  [[nodiscard]] KnotState knot_at(double arc_V) const;
  struct Expected {
    Rigid3 T_L_C;
    double position_sigma_m, rotation_sigma_rad;
  };
  [[nodiscard]] Expected expected_at(DeviceTime time) const;  // after the path's end
  [[nodiscard]] std::vector<Rigid3> alignments_with(const JointSegment& later) const;
  void append(const JointSegment& later, const Rigid3& T_first_second);
  [[nodiscard]] Misreads misreads_configured() const {
    return {config_.joint.flip_probability, config_.joint.outlier_probability};
  }
  [[nodiscard]] std::vector<StartCandidate> search_starts(const Misreads& misreads);
  void adopt(const StartCandidate& candidate);
  bool start();
  void iterate(Depth depth);
  void consider_rivals();
  void try_starts(std::vector<JointSegment>& solutions) const;
  void try_offsets(std::vector<JointSegment>& solutions) const;
  void forget_solution();  // shared states and strengths as they are before any read
  void set_drift(double factor);
  void estimate_drift();
  [[nodiscard]] double total_evidence() const;
  enum class Effort { kNew, kRefresh, kAll };  // search new and open tags; refine all modes; search all
  void place(Effort effort);
  void select();
  void estimate_signal_level();
  [[nodiscard]] SharedLayout layout() const {
    return {static_cast<int>(shared_.ports.size()), static_cast<int>(shared_.knots.size())};
  }
  void refine(bool shape);
  void estimate_noise(const std::vector<Candidate>& some, bool shape, JointProblem& problem, JointState& state);
  [[nodiscard]] Eigen::MatrixXd missing_information() const;
  void compute_covariance();
  void estimate_electrical_lengths();

  Config config_;
  Calibration calibration_;
  std::vector<std::uint32_t> ids_;
  Anchor anchor_;
  OdometryPath path_;
  BeamModel beams_;
  std::map<Epc, SegmentTag> tags_;
  double reference_frequency_hz_ = 0.0;
  DeviceTime start_time_;

  bool started_ = false;
  double next_start_arc_V_ = 0.0;
  double evidence_ = 0.0;             // total_evidence() when rivals were last considered
  std::vector<JointSegment> rivals_;  // other solutions, nearly as likely
  double evidence_margin_ = 0.0;      // ln likelihood ratio of the scale against the best other one
  StructuredShape structured_;
  Misreads misreads_;
  double drift_factor_ = 1.0;  // of the odometry against the configuration, as the reads show
  double scale_walk_per_sqrt_m_ = 0.0, rotation_walk_rad_per_sqrt_m_ = 0.0, position_walk_m_per_sqrt_m_ = 0.0;
  double knot_spacing_V_ = 1.0;
  JointState shared_;  // tags stand in tags_
  JointCovariance covariance_;
  std::uint32_t revision_ = 0;
  std::uint64_t rejected_ = 0;
};

}  // namespace rfmvo
