#include "edges/recorder/journal_names.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>

namespace rfmvo {
namespace {

constexpr std::string_view kExtension = ".lcmlog", kUnfinished = ".tmp";
constexpr std::size_t kFewestDigits = 4, kMostDigits = 9;

}  // namespace

std::string SegmentName::path() const {
  char digits[16] = "";
  if (number > 1) (void)std::snprintf(digits, sizeof(digits), ".%04d", number);
  return run + digits + std::string(kExtension);
}

std::string SegmentName::path_on_disk() const { return path() + (unfinished ? std::string(kUnfinished) : ""); }

std::optional<SegmentName> segment_name(std::string_view path) {
  SegmentName name;
  name.unfinished = path.ends_with(kUnfinished);
  if (name.unfinished) path.remove_suffix(kUnfinished.size());
  if (!path.ends_with(kExtension)) return std::nullopt;
  path.remove_suffix(kExtension.size());
  if (path.empty() || path.ends_with('/')) return std::nullopt;
  const std::size_t dot = path.rfind('.');
  const std::string_view digits = dot == std::string_view::npos ? "" : path.substr(dot + 1);
  const bool numbered = digits.size() >= kFewestDigits && digits.size() <= kMostDigits &&
                        std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (numbered) {
    (void)std::from_chars(digits.data(), digits.data() + digits.size(), name.number);
    if (name.number < 2) return std::nullopt;
    path.remove_suffix(digits.size() + 1);
  }
  name.run = std::string(path);
  return name;
}

}  // namespace rfmvo
