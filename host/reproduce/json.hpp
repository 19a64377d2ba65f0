// All numbers of the page.
#pragma once

#include <string>

#include "reproduce/study.hpp"

namespace rfmvo::reproduce {

// {"options", "summary": [{"id", "quantity", "unit", "published", "paper", "repaired", "joint", "tagoram",
// "mobitagbot"}],
//  "figures": [{"id", "heading", "x", "y", "curves": [{"key", "points": [[x, y]]}]}], "sweeps", "conditions",
//  "reasons", "run_times", "tags": [{"seed", "tag", "error_m": {method: number or null}}], "real_frames": null or
//  {"summary", "tags", ...}}.
// What is not known is null.
[[nodiscard]] std::string to_json(const Options& options, const Results& results);

}  // namespace rfmvo::reproduce
