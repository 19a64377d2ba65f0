// One self-contained HTML page about a result: opens without a network, prints.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "estimator/estimate.hpp"
#include "report/journal_data.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::report {

// `name`: the result's name, shown as the title. Errors: those of evaluate(), and gnuplot's.
[[nodiscard]] Result<std::string> make_report(const std::vector<Estimate>& estimates,
                                              const std::optional<simulate::Truth>& truth, const std::string& name,
                                              std::optional<JournalData> journal = std::nullopt);

}  // namespace rfmvo::report
