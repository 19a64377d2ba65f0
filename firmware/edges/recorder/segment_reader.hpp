// The records of a log and, if it is a segment of a journal, of the segments that follow it. The record that a segment
// begins with is left out where it only repeats the first one. A segment that was still being written ends at its last
// whole record.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "edges/log_file.hpp"
#include "edges/recorder/journal_names.hpp"

namespace rfmvo {

class SegmentReader {
 public:
  // Errors: of LogFileReader::open. Where there is no such file, PATH.tmp will do.
  [[nodiscard]] static Result<std::unique_ptr<SegmentReader>> open(const std::string& path);

  // As LogFileReader::next(). The first record of each segment always comes with its data.
  [[nodiscard]] Result<std::optional<LogRecord>> next(bool with_data = true);
  [[nodiscard]] std::string where(std::int64_t offset) const { return file_->where(offset); }

 private:
  SegmentReader(std::unique_ptr<LogFileReader> file, std::optional<SegmentName> name)
      : file_(std::move(file)), name_(std::move(name)) {}
  [[nodiscard]] bool open_next();

  std::unique_ptr<LogFileReader> file_;
  std::optional<SegmentName> name_;  // none: not a segment's name
  std::optional<LogRecord> first_;   // of the first segment
  bool at_begin_ = true;             // of a segment
};

}  // namespace rfmvo
