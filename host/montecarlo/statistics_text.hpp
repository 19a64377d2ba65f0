// Statistics for people (a table) and for programs (JSON).
#pragma once

#include <string>
#include <vector>

#include "montecarlo/statistics.hpp"

namespace rfmvo::montecarlo {

// One row per seed, then what they say together.
[[nodiscard]] std::string to_table(const std::vector<SeedRun>& runs, const Statistics& statistics);

// {"run": {scene, estimator, ...}, "rmse_m", "bound_rmse_m", "ratio", "median_error_m", ..., "statuses": {},
//  "seeds": [{"seed", "rmse_m", ...}]}; what is not known is null. Shares are of all tags, but coverage95
//  and nees, which are of the located ones.
[[nodiscard]] std::string to_json(const Options& options, const std::vector<SeedRun>& runs,
                                  const Statistics& statistics);

}  // namespace rfmvo::montecarlo
