// A Bound for people (a table) and for programs (JSON).
#pragma once

#include <string>

#include "bound/bound.hpp"
#include "bound/lobes.hpp"

namespace rfmvo::bound {

// The same run with the path unknown and known, and what lobes add to the former.
struct RunBounds {
  Bound unknown, known;
  Lobes lobes;
};

[[nodiscard]] std::string to_table(const RunBounds& bounds);

// {"bound_rmse_m", "bound_median_m", "scale_bound_relative", "known_path_bound_rmse_m", ..., "tags": [{"epc",
//  "reads", "distance_m", "sigma_m", "sigma_C_m", "known_path_sigma_m", "lobes", ...}]}; unbounded is null.
[[nodiscard]] std::string to_json(const RunBounds& bounds);

}  // namespace rfmvo::bound
