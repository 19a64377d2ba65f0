#include "play/merged_logs.hpp"

namespace rfmvo::play {

Result<MergedLogs> MergedLogs::open(const std::vector<std::string>& paths) {
  MergedLogs merged;
  for (const std::string& path : paths) {
    auto file = LogFileReader::open(path);
    if (!file) return file.error();
    Log log{std::move(file).value(), std::nullopt};
    auto record = log.file->next();
    if (!record) return record.error();
    log.record = std::move(record).value();
    merged.logs_.push_back(std::move(log));
  }
  return merged;
}

Result<std::optional<LogRecord>> MergedLogs::next() {
  Log* earliest = nullptr;
  for (Log& log : logs_)
    if (log.record && (earliest == nullptr || log.record->utime < earliest->record->utime)) earliest = &log;
  if (earliest == nullptr) return std::optional<LogRecord>();
  std::optional<LogRecord> record = std::move(earliest->record);
  auto following = earliest->file->next();
  if (!following) return following.error();
  earliest->record = std::move(following).value();
  return record;
}

}  // namespace rfmvo::play
