// All positions of one tag that its reads allow, given the path: the spectrum's peaks, each refined
// to a maximum of the likelihood and weighted by it. docs/estimator.md, section 5.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/joint_problem.hpp"
#include "estimator/near_field_spectrum.hpp"
#include "estimator/signal_strength.hpp"

namespace rfmvo {

struct TagMode {
  TagState tag;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  // (position, offset) given the shared states
  double cost = 0.0;                                     // of the phases, as solve() has it
  double signal_cost = 0.0;                              // of the signal strengths
  double log_evidence = 0.0;  // ln of its share of the likelihood's integral, up to a constant of the tag
  double weight = 0.0;        // posterior probability among the modes (Laplace's approximation)
};

// Reads of one tag as the spectrum wants them, at the given states. With `coherent` all ports form
// one group (their offsets are known), else each its own.
[[nodiscard]] std::vector<SpectrumRead> spectrum_reads(const std::vector<JointRead>& reads, const JointState& state,
                                                       const BeamModel& beams, bool coherent, std::size_t max_reads);

// Posterior probabilities from log_evidence; the heaviest first.
void weigh_modes(std::vector<TagMode>& modes);

// Where a tag may be at one scale, whatever the ports' offsets and small changes of the path: peaks of its
// incoherent spectrum, strongest first. The only costly search; it is kept while the scale stays.
struct PossiblePlaces {
  std::vector<Eigen::Vector3d> p_W_X;
  double log_scale = 0.0;  // that they were found at

  // All lengths grow with the scale.
  [[nodiscard]] std::vector<Eigen::Vector3d> at(double log_scale) const;
};

struct PlaceOptions {
  double finest_m = 0.06, widest_m = 0.25;  // the grid's spacing lies between
  double range_max_m = 5.0;
  std::size_t max_reads = 48;
  int count = 48;
};

[[nodiscard]] PossiblePlaces search_places(const std::vector<JointRead>& reads, const JointState& state,
                                           const BeamModel& beams, const PlaceOptions& options);

// Modes of tag `index`, best first; shared states fixed: the places where all ports agree best, refined. At most
// `count`.
[[nodiscard]] std::vector<TagMode> find_modes(const JointProblem& problem, std::size_t index, const JointState& state,
                                              const BeamModel& beams, const std::vector<Eigen::Vector3d>& places,
                                              std::size_t count);

// The same modes after the shared states have moved: each refined from where it was, no new search.
[[nodiscard]] std::vector<TagMode> refresh_modes(const JointProblem& problem, std::size_t index,
                                                 const JointState& state, const BeamModel& beams,
                                                 const std::vector<TagMode>& modes);

}  // namespace rfmvo
