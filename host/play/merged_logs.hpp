// Several logs as one, in the order of their times: a journal and its result, say.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edges/log_file.hpp"

namespace rfmvo::play {

class MergedLogs {
 public:
  // Errors: as LogFileReader::open.
  [[nodiscard]] static Result<MergedLogs> open(const std::vector<std::string>& paths);
  // The earliest of the logs' next records; of equal times, that of the log that was named first.
  [[nodiscard]] Result<std::optional<LogRecord>> next();

 private:
  struct Log {
    std::unique_ptr<LogFileReader> file;
    std::optional<LogRecord> record;  // the next one
  };
  std::vector<Log> logs_;
};

}  // namespace rfmvo::play
