// Antenna arrays of a recorded run to time the stages on.
#pragma once

#include <vector>

#include "estimator/joint_optimization.hpp"
#include "estimator/sampling_synchronization.hpp"
#include "estimator/spatial_power_spectrum.hpp"
#include "montecarlo/recording.hpp"

namespace rfmvo::reproduce {

// Stage 1 over the whole recording.
[[nodiscard]] std::vector<SampledRead> synchronized_reads(const montecarlo::Recording& recording, const Config& config);

// The first `elements` reads on every antenna of the first tag that has so many on each, to the letter (no repairs);
// empty if there is none.
[[nodiscard]] std::vector<AntennaArray> first_arrays(const std::vector<SampledRead>& reads,
                                                     const Calibration& calibration, std::int64_t elements);

// What the joint optimization starts from where no other array shares an element.
[[nodiscard]] std::vector<AntennaTerm> terms_of(const std::vector<AntennaArray>& arrays, const SpectrumPeak& peak);

}  // namespace rfmvo::reproduce
