// Global start: no scale, no position, no port offset is known. A grid of scales; at each, the best
// place of a few tags in the near-field spectrum; the best scales are refined by the joint solver
// and compared by their likelihood. docs/estimator.md, section 5.
#pragma once

#include <vector>

#include "estimator/joint_problem.hpp"
#include "estimator/tag_modes.hpp"

namespace rfmvo {

struct StartOptions {
  double log_scale_min = -3.0, log_scale_max = 3.0;
  double log_scale_step = 0.06;
  double coarse_cell_m = 0.10;
  double range_max_m = 4.0;
  std::size_t first_tags = 3, all_tags = 12;  // scales are sifted with the first, judged with all
  std::size_t max_reads = 32;                 // per tag
  std::size_t scales = 5;                     // that are looked at with all tags,
  std::size_t offsets_per_scale = 3;          // sets of port offsets of each,
  std::size_t candidates = 5;                 // best of both that are refined
};

struct StartCandidate {
  JointState state;                    // tags that were not used keep their state
  std::vector<std::size_t> used;       // tags that took part,
  std::vector<PossiblePlaces> places;  // and where they may be at this scale
  double evidence = 0.0;               // of the tags that took part, see joint_solver.hpp
};

// Candidates with distinct scales, best first. `state` brings priors (lever arms, electrical
// lengths, noise strengths); problem.reference_scale_m of each candidate is exp(its log_scale).
[[nodiscard]] std::vector<StartCandidate> find_starts(const JointProblem& problem, const JointState& state,
                                                      const BeamModel& beams, const StartOptions& options);

}  // namespace rfmvo
