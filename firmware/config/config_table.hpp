// One row per configuration key: the only place that knows names, units, ranges and documentation.
// The TOML reader, `rfmvo configure`, the manual and the journal are all driven by it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "base/result.hpp"
#include "config/config.hpp"

namespace rfmvo {

struct ConfigRow {
  using Real = double& (*)(Config&);
  using Integer = std::int64_t& (*)(Config&);
  using Flag = bool& (*)(Config&);
  using Text = std::string& (*)(Config&);

  std::string_view key;   // "section.name"
  std::string_view unit;  // "m", "rad", ..., "" for none
  std::variant<Real, Integer, Flag, Text> member;
  double min = 0.0, max = 0.0;    // of numbers, inclusive
  std::string_view choices;       // of text, "a|b|c"; empty = any
  std::string_view doc;
};

using ConfigValue = std::variant<double, std::int64_t, bool, std::string>;

[[nodiscard]] std::span<const ConfigRow> config_rows();
[[nodiscard]] const ConfigRow* find_row(std::string_view key);

// Checks type and range and writes the member. Errors name the key, the unit, the range and, for an
// unknown key, the nearest known one.
[[nodiscard]] Status set_value(Config& config, std::string_view key, const ConfigValue& value);
[[nodiscard]] ConfigValue get_value(const Config& config, const ConfigRow& row);

}  // namespace rfmvo
