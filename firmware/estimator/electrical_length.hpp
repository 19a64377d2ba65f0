// Excess electrical length of a port (cable, reader, antenna) from the reader's frequency hops: the
// phase jumps by 4 pi L df / c at each hop, while the antenna has hardly moved. docs/estimator.md, section 5.
#pragma once

#include <vector>

#include "estimator/joint_problem.hpp"

namespace rfmvo {

struct ElectricalLength {
  double length_m = 0.0;   // includes the mean distance to the tags (the wave travels that too)
  double coherence = 0.0;  // 0..1: how well one length explains the hops; 0 = no hops seen
  // Coherence in sigmas of what hops of random phases show at one length. The best of many lengths reaches 3 in noise.
  double significance = 0.0;
};

// chains: reads of one (tag, port) each, in time order, with their times in seconds.
struct TimedPhase {
  double time_s = 0.0;
  double phase_rad = 0.0;
  double frequency_term_rad_m = 0.0;  // 4 pi (f - f_ref) / c
};
[[nodiscard]] ElectricalLength electrical_length_from_hops(const std::vector<std::vector<TimedPhase>>& chains);

}  // namespace rfmvo
