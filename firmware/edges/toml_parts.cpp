#include "edges/toml_parts.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace rfmvo::toml_parts {
Result<toml::table> parse_document(std::string_view toml, const std::string& where) {
  try {
    return toml::parse(toml);
  } catch (const toml::parse_error& error) {
    const auto line = std::to_string(error.source().begin.line);
    return Error{ErrorCode::kMalformed, "not valid TOML: " + std::string(error.description()), where + ":" + line};
  }
}

std::string place(const std::string& where, const toml::node& node) {
  return where + ":" + std::to_string(node.source().begin.line);
}

std::string text_of(double value) {
  RFMVO_ASSERT(std::isfinite(value));
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  std::string text(buffer.data(), end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";  // else it would be an integer
  return text;
}

std::string text_of(std::int64_t value) { return std::to_string(value); }
std::string text_of(bool value) { return value ? "true" : "false"; }

std::string text_of(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04X", byte);
      text += escape.data();
    } else {
      text += c;
    }
  }
  return text + "\"";
}

}  // namespace rfmvo::toml_parts
