// The reads of a recorded run as the baselines get them: antennas at their TRUE places, phases of all channels brought
// to one.
#pragma once

#include <map>
#include <vector>

#include "baselines/hologram.hpp"
#include "estimator/event.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::baselines {

// By tag, in time order. Hopping is calibrated as in the paper's estimator (estimator/phase_calibration.hpp): one
// excess electrical length per port, learnt from all hops of the run, brings phases to the mean carrier; where it
// cannot be learnt, each channel is a group of its own. Reads outside of the true path, of several
// singulations (seen_count) or of an antenna that is not in the truth are left out.
[[nodiscard]] std::map<Epc, std::vector<KnownRead>> known_reads(const std::vector<Event>& events,
                                                                const simulate::Truth& truth);

}  // namespace rfmvo::baselines
