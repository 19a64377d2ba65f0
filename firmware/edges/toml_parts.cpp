#include "edges/toml_parts.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

namespace rfmvo::toml_parts {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20;

}  // namespace

Result<toml::table> parse_document(std::string_view toml, const std::string& where) {
  try {
    return toml::parse(toml);
  } catch (const toml::parse_error& error) {
    const auto line = std::to_string(error.source().begin.line);
    return Error{ErrorCode::kMalformed, "not valid TOML: " + std::string(error.description()), where + ":" + line};
  }
}

Result<std::string> read_text(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"), &std::fclose);
  if (file == nullptr) {
    const bool missing = errno == ENOENT || errno == ENOTDIR;
    return Error{missing ? ErrorCode::kNotFound : ErrorCode::kUnreadable,
                 missing ? "no such file" : std::string("cannot be read: ") + std::strerror(errno), path};
  }
  std::string text(kMaxFileBytes + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  if (std::ferror(file.get()) != 0)
    return Error{ErrorCode::kUnreadable, std::string("cannot be read: ") + std::strerror(errno), path};
  if (text.size() > kMaxFileBytes) return Error{ErrorCode::kMalformed, "larger than 1 MB", path};
  return text;
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
