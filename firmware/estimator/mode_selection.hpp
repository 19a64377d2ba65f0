// Which of a tag's modes suits all the other tags' reads: each mode's likelihood with the path, the scale
// and the port offsets free to follow, as far as the other reads and the priors let them.
// docs/estimator.md, section 5.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/joint_solver.hpp"
#include "estimator/tag_modes.hpp"

namespace rfmvo {

// What everything but one tag's reads says of the shared states, about their present values:
// cost(y) = const - gradient^T y + 1/2 y^T information y.
struct OtherReads {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

// Takes an entry of the joint problem out again: `own` is its coupling in the state in which it took part, with
// this share. Starts from JointCovariance's information and no gradient: at a solution all gradients cancel.
void take_out(const TagCoupling& own, double share, OtherReads& others);

// Weighs the modes of the tag that `one` holds alone by their marginal likelihood (Laplace) and puts the heaviest
// first; each covariance becomes that of (position, offset) with the shared states uncertain.
// `shared` brings the shared states.
void select_modes(const JointProblem& one, const JointState& shared, const OtherReads& others,
                  std::vector<TagMode>& modes);

}  // namespace rfmvo
