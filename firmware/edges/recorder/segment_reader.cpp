#include "edges/recorder/segment_reader.hpp"

#include <filesystem>

namespace rfmvo {

Result<std::unique_ptr<SegmentReader>> SegmentReader::open(const std::string& path) {
  std::optional<SegmentName> name = segment_name(path);
  std::error_code ignored;
  if (name && !std::filesystem::exists(path, ignored) && std::filesystem::exists(path + ".tmp", ignored))
    name->unfinished = true;
  auto file = LogFileReader::open(name ? name->path_on_disk() : path);
  if (!file) return file.error();
  return std::unique_ptr<SegmentReader>(new SegmentReader(std::move(file).value(), std::move(name)));
}

bool SegmentReader::open_next() {
  if (!name_ || name_->unfinished) return false;
  for (const bool unfinished : {false, true}) {
    SegmentName next = name_->next();
    next.unfinished = unfinished;
    auto file = LogFileReader::open(next.path_on_disk());
    if (!file) continue;
    file_ = std::move(file).value();
    name_ = std::move(next);
    at_begin_ = true;
    return true;
  }
  return false;
}

Result<std::optional<LogRecord>> SegmentReader::next(bool with_data) {
  while (true) {
    auto read = file_->next(with_data || at_begin_);
    if (!read && !(name_ && name_->unfinished)) return read;
    if (!read || !read.value()) {
      if (open_next()) continue;
      return std::optional<LogRecord>();
    }
    const bool at_begin = std::exchange(at_begin_, false);
    const LogRecord& record = *read.value();
    if (!at_begin) return read;
    if (first_ && record.channel == first_->channel && record.data == first_->data) continue;
    if (!first_) first_ = record;
    return read;
  }
}

}  // namespace rfmvo
