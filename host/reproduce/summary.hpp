// The table: published numbers beside measured ones.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "reproduce/results.hpp"

namespace rfmvo::reproduce {

// Columns of the table; the paper's estimator has its rows without section IV, too.
enum class Column : std::uint8_t { kPaper, kRepaired, kJoint, kTagoram, kMobiTagbot };
inline constexpr std::size_t kColumns = 5;
inline constexpr std::array<const char*, kColumns> kColumnKeys{"paper", "repaired", "joint", "tagoram", "mobitagbot"};
inline constexpr std::array<const char*, kColumns> kColumnTitles{"paper", "repaired", "joint", "Tagoram", "MobiTagbot"};

struct SummaryRow {
  std::string id, quantity, unit;
  std::string published;  // by RF-MVO's authors; empty: nothing
  std::array<std::optional<double>, kColumns> values;
  int digits = 1;
};

// Of one scene. Errors of tags: over the located ones; a row tells how many these are.
[[nodiscard]] std::vector<SummaryRow> summary_of(const Study& study);

// Values of all runs, located or present ones.
[[nodiscard]] std::vector<double> all_tag_errors_m(const Study& study, Method method);
[[nodiscard]] std::vector<ScaleError> all_scale_errors(const Study& study, Method method);
[[nodiscard]] std::size_t all_tags(const Study& study);

}  // namespace rfmvo::reproduce
