// How the files of a journal are called. The first segment is RUN.lcmlog, those that follow RUN.0002.lcmlog and so on;
// the one that is being written ends in .tmp.
#pragma once

#include <compare>
#include <optional>
#include <string>
#include <string_view>

namespace rfmvo {

struct SegmentName {
  std::string run;  // with its folder
  int number = 1;
  bool unfinished = false;

  [[nodiscard]] std::string path() const;          // without .tmp, also of an unfinished one
  [[nodiscard]] std::string path_on_disk() const;  // with it
  [[nodiscard]] SegmentName next() const { return {run, number + 1, unfinished}; }
  auto operator<=>(const SegmentName&) const = default;
};

// Nothing if the file is no segment.
[[nodiscard]] std::optional<SegmentName> segment_name(std::string_view path);

}  // namespace rfmvo
