// All positions of one tag that its reads allow, given the path: the spectrum's peaks, each refined
// to a maximum of the likelihood and weighted by it. docs/estimator.md, section 5.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/joint_problem.hpp"
#include "estimator/near_field_spectrum.hpp"

namespace rfmvo {

struct TagMode {
  TagState tag;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  // (position, offset) given the shared states
  double cost = 0.0;    // as solve() has it
  double weight = 0.0;  // posterior probability among the modes (Laplace's approximation)
};

struct BeamModel {
  std::vector<Eigen::Vector3d> boresight_C;  // per port
};

// Reads of one tag as the spectrum wants them, at the given states. With `coherent` all ports form
// one group (their offsets are known), else each its own.
[[nodiscard]] std::vector<SpectrumRead> spectrum_reads(const std::vector<JointRead>& reads, const JointState& state,
                                                       const BeamModel& beams, bool coherent, std::size_t max_reads);

// Posterior probabilities from cost and covariance; the heaviest first.
void weigh_modes(std::vector<TagMode>& modes);

// Modes of tag `index`, best first; shared states fixed. Empty if no position is in the
// beam. The grid's spacing is chosen here.
[[nodiscard]] std::vector<TagMode> find_modes(const JointProblem& problem, std::size_t index, const JointState& state,
                                              const BeamModel& beams, SpectrumOptions options, bool coherent,
                                              std::size_t max_reads);

// The same modes after the shared states have moved: each refined from where it was, no new search.
[[nodiscard]] std::vector<TagMode> refresh_modes(const JointProblem& problem, std::size_t index,
                                                 const JointState& state, const std::vector<TagMode>& modes);

}  // namespace rfmvo
