// The joint least-squares problem of one odometry segment: reads, states, priors. What the solver
// (joint_solver.hpp) minimises. docs/estimator.md, section 3.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "estimator/phase_error_model.hpp"
#include "estimator/phase_model.hpp"

namespace rfmvo {

// Drift of the odometry, corrected at knots along the path and interpolated between them.
struct KnotState {
  Eigen::Vector3d path_correction_W = Eigen::Vector3d::Zero();      // d, m
  Eigen::Vector3d rotation_correction_W = Eigen::Vector3d::Zero();  // theta, rad
  double log_scale_drift = 0.0;                                     // epsilon: scale here / scale at the start - 1
};

struct PortState {
  double offset_rad = 0.0;  // relative to the first port
  double electrical_length_m = 0.0;
  Eigen::Vector3d lever_arm_C = Eigen::Vector3d::Zero();
};

struct TagState {
  Eigen::Vector3d p_W_X = Eigen::Vector3d::Zero();
  double offset_rad = 0.0;
  double structured_sigma_rad = 0.4;
};

struct JointState {
  double log_scale = 0.0;
  double time_offset_s = 0.0;
  std::vector<PortState> ports;
  std::vector<KnotState> knots;
  std::vector<TagState> tags;
};

struct JointRead {
  ReadGeometry geometry;
  double phase_rad = 0.0;                           // measured
  double white_rad2 = 0.0;                          // variance of the uncorrelated error
  double rssi_db = 0.0;                             // dBm
  double fade_db = 0.0;                             // below the tag's strong reads
  Eigen::Vector3d p_W_A = Eigen::Vector3d::Zero();  // antenna at the reference scale: distances between reads
  int port = 0;                                     // index into ports
  int knot = 0;                                     // the read lies between knot and knot + 1,
  double knot_fraction = 0.0;                       // this far along
};

// The stretch of path between two neighbouring knots.
struct KnotInterval {
  Eigen::Vector3d step_W = Eigen::Vector3d::Zero();  // unscaled displacement, axes of W
  double length_V = 0.0;                             // travel, units of V
  bool gap = false;  // the odometry was lost here: nothing is known of the step but what the reads tell
};

struct JointPriors {
  double time_offset_sigma_s = 0.005;
  std::vector<double> electrical_length_m, electrical_length_sigma_m;  // per port
  std::vector<Eigen::Vector3d> lever_arm_C;                            // per port, m
  std::vector<Eigen::Vector3d> lever_arm_sigma_m;                      // per port, axes of C; above 0,
  double lever_arms_common_sigma_m = 0.0;        // and of all together: the camera in the frame of the antennas
  double scale_walk_per_sqrt_m = 0.0035;         // of epsilon
  double rotation_walk_rad_per_sqrt_m = 0.0044;  // of theta, per axis
  double position_walk_m_per_sqrt_m = 0.001;     // of d beside what epsilon and theta explain, per axis
};

struct JointProblem {
  std::vector<std::vector<JointRead>> reads;  // per tag; grouped by port, in time order within a port
  // How much of each entry of `reads` counts; empty: all of it. A tag whose position is undecided has one entry
  // per mode, with the probability of the mode (expectation maximisation).
  std::vector<double> share;
  std::vector<KnotInterval> intervals;  // knots - 1
  JointPriors priors;
  double reference_scale_m =
      1.0;                     // metres per unit of V for the widths of priors and correlations; fixed while solving
  StructuredShape structured;  // of the phase error
  double flip_probability = 0.003;    // share of reads that are turned by pi; they come in bursts
  double outlier_probability = 0.01;  // of a phase that tells nothing
};

[[nodiscard]] inline double share_of(const JointProblem& problem, std::size_t tag) {
  return problem.share.empty() ? 1.0 : problem.share[tag];
}

[[nodiscard]] ReadStates states_at(const JointRead& read, const JointState& state, const TagState& tag);

}  // namespace rfmvo
