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
  bool live = false;              // a change takes effect while running; of others, by a new run
};

inline constexpr std::size_t kMaxTextLength = 1024;  // of keys and of text values, bytes

using ConfigValue = std::variant<double, std::int64_t, bool, std::string>;

[[nodiscard]] std::span<const ConfigRow> config_rows();
[[nodiscard]] const ConfigRow* find_row(std::string_view key);

// Checks type and range and writes the member. Errors name the key, the unit, the range and, for an
// unknown key, the nearest known one.
[[nodiscard]] Status set_value(Config& config, std::string_view key, const ConfigValue& value);
// Works on numbers given as text too ("--set key=value"): the row's type decides how `text` is read.
[[nodiscard]] Status set_value_from_text(Config& config, std::string_view key, std::string_view text);
// What one key's range cannot say: pairs that must be ordered.
[[nodiscard]] Status check_consistency(const Config& config);
[[nodiscard]] ConfigValue get_value(const Config& config, const ConfigRow& row);

// "unknown key; did you mean ...?" with the nearest of the known keys (not empty) by edit distance.
[[nodiscard]] Error unknown_key(std::string_view key, std::span<const std::string_view> known);

}  // namespace rfmvo
