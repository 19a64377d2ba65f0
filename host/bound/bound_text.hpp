// A Bound for people (a table) and for programs (JSON).
#pragma once

#include <string>

#include "bound/bound.hpp"

namespace rfmvo::bound {

// The same run with the path unknown and known.
struct BoundPair {
  Bound unknown, known;
};

[[nodiscard]] std::string to_table(const BoundPair& bounds);

// {"bound_rmse_m", "bound_median_m", "scale_bound_relative", "known_path_bound_rmse_m", ..., "tags": [{"epc",
//  "reads", "distance_m", "sigma_m", "sigma_C_m", "known_path_sigma_m"}]}; unbounded is null.
[[nodiscard]] std::string to_json(const BoundPair& bounds);

}  // namespace rfmvo::bound
