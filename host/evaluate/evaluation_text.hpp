// An Evaluation for people (a table) and for programs (JSON).
#pragma once

#include <optional>
#include <string>

#include "evaluate/evaluation.hpp"

namespace rfmvo::evaluate {

[[nodiscard]] std::string to_table(const Evaluation& evaluation);

// {"tags": {total, located, mean_error_m, rmse_m, camera_relative_mean_m, coverage95, ...},
//  "scale": {relative_error, eq31, ...}, "trajectory": {ate_se3_m, ate_sim3_m, path_m, ...},
//  "realtime_factor": number or null}; what is not known is null.
[[nodiscard]] std::string to_json(const Evaluation& evaluation, std::optional<double> realtime_factor);

// "realtime_factor" of the JSON that `rfmvo replay --json` writes; nothing if it is null there.
// Errors: no JSON, no such key, not a number.
[[nodiscard]] Result<std::optional<double>> realtime_factor_of(const std::string& replay_json,
                                                               const std::string& where);

}  // namespace rfmvo::evaluate
