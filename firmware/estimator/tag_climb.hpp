// One tag's likelihood with the path as it is: antenna places and all offsets but the tag's own are known, so a
// read costs one distance. What modes are refined and compared with. docs/estimator.md, section 5.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/chain_whitening.hpp"
#include "estimator/joint_problem.hpp"

namespace rfmvo {

class TagLikelihood {
 public:
  // Keeps references: `reads` and `problem` must outlive it. structured_sigma_rad: of the tag.
  TagLikelihood(const std::vector<JointRead>& reads, const JointProblem& problem, const JointState& state,
                double structured_sigma_rad);

  // The offset that suits the reads best at a place: the angle of the sum of phasors.
  [[nodiscard]] double best_offset_rad(const Eigen::Vector3d& p_W_X) const;

  struct Maximum {
    Eigen::Vector3d p_W_X = Eigen::Vector3d::Zero();
    double offset_rad = 0.0;
    double cost = 0.0;                                     // as solve() has it, but for the prior of the shared states
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  // of (position, offset)
  };
  // Levenberg-Marquardt uphill from a place.
  [[nodiscard]] Maximum climb(const Eigen::Vector3d& from_W);

  // Share of the reads whose antenna is nearer to the place than range_m.
  [[nodiscard]] double share_within(double range_m, const Eigen::Vector3d& p_W_X) const;

 private:
  struct Seen {
    Eigen::Vector3d p_W_A;
    double wavenumber_rad_m, phase_rad;  // measured less all that is not distance or the tag's own offset
  };
  double evaluate(const Eigen::Vector3d& p_W_X, double offset_rad, Derivatives derivatives);

  const std::vector<JointRead>& reads_;
  const JointProblem& problem_;
  std::vector<Seen> seen_;
  ChainConditioning conditioning_;
  WhitenedTag whitened_;
};

}  // namespace rfmvo
