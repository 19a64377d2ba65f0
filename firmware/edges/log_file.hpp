// An LCM event log as a file of records, without their meaning. Format (LCM 1.x, big-endian): sync
// word 0xEDA1DA01, event number i64, utime i64 (us), channel length i32, data length i32, channel, data.
// Own reader, because liblcm's skips garbage in silence and takes a truncated file for a whole one.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace rfmvo {

struct LogRecord {
  std::int64_t offset = 0;  // of the record in the file, bytes
  std::int64_t number = 0;  // the event number: counts up by one, unless something was lost before it was recorded
  std::int64_t utime = 0;   // us
  std::string channel;
  std::vector<std::uint8_t> data;
};

// Appends one record to `out`. channel: 1..63 bytes; data: what the header can say.
void append_log_record(std::vector<std::uint8_t>& out, std::int64_t number, std::int64_t utime,
                       std::string_view channel, std::span<const std::uint8_t> data);

// Writes PATH.tmp, which becomes PATH when close() succeeds and is removed otherwise.
class LogFileWriter {
 public:
  // Errors: kUnwritable naming the path (folder missing, no permission, being written by another program).
  [[nodiscard]] static Result<std::unique_ptr<LogFileWriter>> create(const std::string& path);
  ~LogFileWriter();
  LogFileWriter(const LogFileWriter&) = delete;
  LogFileWriter& operator=(const LogFileWriter&) = delete;

  // channel: 1..63 bytes.
  [[nodiscard]] Status write(std::string_view channel, std::int64_t utime, std::span<const std::uint8_t> data);
  [[nodiscard]] Status close();  // flush, fsync, rename

 private:
  LogFileWriter(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {}

  std::string path_;
  std::FILE* file_;
  std::int64_t count_ = 0;
};

class LogFileReader {
 public:
  // Errors: kNotFound, kUnreadable; kMalformed if the file is empty.
  [[nodiscard]] static Result<std::unique_ptr<LogFileReader>> open(const std::string& path);
  ~LogFileReader();
  LogFileReader(const LogFileReader&) = delete;
  LogFileReader& operator=(const LogFileReader&) = delete;

  // The next record; nothing at the end. Errors: kMalformed with file and byte offset. With
  // with_data = false the data is jumped over (but must be there).
  [[nodiscard]] Result<std::optional<LogRecord>> next(bool with_data = true);
  // "FILE: byte OFFSET", for errors in what a record holds.
  [[nodiscard]] std::string where(std::int64_t offset) const;
  [[nodiscard]] std::int64_t offset() const { return offset_; }  // behind the last record

 private:
  LogFileReader(std::string path, std::FILE* file, std::int64_t size) : path_(std::move(path)), file_(file), size_(size) {}

  std::string path_;
  std::FILE* file_;
  std::int64_t size_;
  std::int64_t offset_ = 0;
};

}  // namespace rfmvo
