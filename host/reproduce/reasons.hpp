// Why the paper's method has no answer, or a wrong one: counted on the runs.
#pragma once

#include <string>
#include <vector>

#include "reproduce/results.hpp"

namespace rfmvo::reproduce {

// What becomes of the antenna arrays, to the letter or repaired. Each array is counted once.
struct Fate {
  std::size_t tags = 0, tags_with_enough_reads = 0;  // L on one antenna
  std::size_t due = 0;
  std::size_t without_range = 0;    // Eq. (4), (5) exclude each other
  std::size_t truth_excluded = 0;   // the true scale lies outside of their range, whatever came after
  std::size_t not_converged = 0;    // the truth is inside; section IV gives nothing
  std::size_t wrong = 0, good = 0;  // an answer more, less than kGood_m off
  double span_s = 0.0, travel_m = 0.0, distance_m = 0.0;  // medians over the arrays that have a range
  // 2 pi (r - d) 2 / lambda at the ends of an array of this travel and distance: what the plane wave of Eq. (1) misses.
  double curvature_rad = 0.0;
};

[[nodiscard]] Fate fate_of(const Study& study, PaperRun Run::*variant);

// HTML: what happened, and the physics behind it.
[[nodiscard]] std::string reasons_section(const Results& results);

}  // namespace rfmvo::reproduce
