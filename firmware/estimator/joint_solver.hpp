// Levenberg-Marquardt on the joint problem, with the Schur complement over the tags: each tag couples
// only to the shared states (scale, time offset, ports, path), so its four unknowns are eliminated
// first and the rest is one small dense system. docs/estimator.md, section 4.
// 500 tags x 120 reads on one core: 97 ms for 2 iterations; Ceres 2.1 (DENSE_SCHUR, the same Jacobians, no whitening)
// 333 ms for 3 iterations and 20 ms to set the problem up.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/joint_problem.hpp"

namespace rfmvo {

// Where the shared states stand in the reduced system. The first knot is the frame's origin and the
// first port's offset is part of every tag's offset: both are fixed.
struct SharedLayout {
  int ports = 0, knots = 0;
  static constexpr int kLogScale = 0, kTimeOffset = 1, kFirstPort = 2, kPerPort = 5, kPerKnot = 7;
  [[nodiscard]] int port(int p) const { return kFirstPort + kPerPort * p; }         // offset, length, lever arm (3)
  [[nodiscard]] int knot(int k) const { return port(ports) + kPerKnot * (k - 1); }  // k >= 1: d (3), theta (3), epsilon
  [[nodiscard]] int size() const { return port(ports) + kPerKnot * (knots - 1); }
};

struct SolverOptions {
  int max_iterations = 12;
  double step_tolerance = 1e-5;  // relative decrease of the cost that ends the iteration
  bool shared_fixed = false;     // only the tags move (a known path)
};

struct SolverReport {
  double cost = 0.0;  // -ln likelihood up to a constant: robust losses + priors + 1/2 sum ln variance
  int iterations = 0;
  bool converged = false;
};

[[nodiscard]] SolverReport solve(const JointProblem& problem, const SolverOptions& options, JointState& state);

// Joint covariance at the solution: of the shared states, and per tag of (position, offset) with its
// cross-covariance to the shared states.
struct JointCovariance {
  SharedLayout layout;
  Eigen::MatrixXd information;  // of the shared states, tags eliminated
  Eigen::MatrixXd shared;       // inverse of the information, less what is missing of it
  std::vector<Eigen::Matrix4d> tag;
  std::vector<Eigen::MatrixXd> tag_shared;  // 4 x size()
};
// `missing` (size() x size(), or empty): what is not known of the shared states because modes are undecided, as
// information: by Louis (1982) the covariance of the gradient over the modes. `tails`: 1 sigma of the shared states
// counts this much, in their own covariance and in what it does to the tags.
[[nodiscard]] JointCovariance covariance(const JointProblem& problem, const JointState& state,
                                         const Eigen::MatrixXd& missing = {}, double tails = 1.0);

// One tag (problem holds it alone) seen from the shared states: its own covariance with them fixed,
// how it leans on them, and what its reads say of them once the tag itself is eliminated.
struct TagCoupling {
  Eigen::Matrix4d own_covariance = Eigen::Matrix4d::Zero();
  Eigen::MatrixXd H_shared;     // 4 x size(): d2 cost / d tag d shared
  Eigen::MatrixXd information;  // size() x size(), lower triangle valid on both sides
  Eigen::VectorXd gradient;     // -d cost / d shared
};
[[nodiscard]] TagCoupling tag_coupling(const JointProblem& problem, const JointState& state);

// What the reads of the placed tags are worth: ln of (likelihood of this geometry / likelihood of
// phases that tell nothing), less what a search over so many places finds in noise. Positive:
// believable; the difference between two states of the same reads is their ln likelihood ratio.
[[nodiscard]] double evidence(const JointProblem& problem, const JointState& state);

// ln of the integral of the likelihood over all states about a solution (Laplace) and, where a tag has several
// entries, over its modes (the lower bound that expectation maximisation raises), against phases that tell
// nothing. Starts, strengths of noise and of drift are compared by it.
[[nodiscard]] double log_marginal_likelihood(const JointProblem& problem, const JointState& state);

// Robust cost of everything at a state (what solve() minimises).
[[nodiscard]] double total_cost(const JointProblem& problem, const JointState& state);

}  // namespace rfmvo
