#include "estimator/mode_selection.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace rfmvo {
namespace {

double log_determinant(const Eigen::LDLT<Eigen::MatrixXd>& ldlt) {
  return ldlt.vectorD().array().abs().max(1e-300).log().sum();
}

}  // namespace

void take_out(const TagCoupling& own, double share, OtherReads& others) {
  others.information -= share * own.information;
  others.gradient -= share * own.gradient;
}

void select_modes(const JointProblem& one, const JointState& shared, const OtherReads& others,
                  std::vector<TagMode>& modes) {
  const double before = log_determinant(Eigen::LDLT<Eigen::MatrixXd>(others.information));
  JointState state = shared;
  for (TagMode& mode : modes) {
    state.tags = {mode.tag};
    const TagCoupling c = tag_coupling(one, state);
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(others.information + c.information);
    const Eigen::VectorXd pull = c.gradient + others.gradient;
    // Both expansions are about y = 0, so their costs there add up; the joint minimum lies lower.
    const double cost = mode.cost + mode.signal_cost - 0.5 * pull.dot(ldlt.solve(pull));
    const double log_volume = 0.5 * std::log(c.own_covariance.determinant()) - 0.5 * (log_determinant(ldlt) - before);
    mode.log_evidence = log_volume - cost;
    const Eigen::MatrixXd gain = c.own_covariance * c.H_shared;
    mode.covariance = c.own_covariance + gain * ldlt.solve(gain.transpose());
  }
  weigh_modes(modes);
}

}  // namespace rfmvo
