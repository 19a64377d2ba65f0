// What the configuration's and the calibration's TOML share. Not for others.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <toml++/toml.h>

#include "base/result.hpp"

namespace rfmvo::toml_parts {

// Errors: kMalformed with FILE:LINE.
[[nodiscard]] Result<toml::table> parse_document(std::string_view toml, const std::string& where);

// "FILE:LINE" of a node.
[[nodiscard]] std::string place(const std::string& where, const toml::node& node);

// Values as TOML text. Doubles have the fewest digits that read back to the same bits.
[[nodiscard]] std::string text_of(double value);
[[nodiscard]] std::string text_of(std::int64_t value);
[[nodiscard]] std::string text_of(bool value);
[[nodiscard]] std::string text_of(const std::string& value);

}  // namespace rfmvo::toml_parts
