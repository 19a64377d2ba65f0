// A recording on the disk: one LCM log, or a series NAME-00001.lcmlog, NAME-00002.lcmlog, ... of limited size. At any
// time the files hold whole records but for the last bytes: what was recorded survives the end of the program.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "base/result.hpp"
#include "base/time.hpp"
#include "bus/bus_listener.hpp"

namespace rfmvo::record {

struct SeriesSettings {
  std::string path;
  std::uint64_t split_bytes = 0;       // a new file beyond this; 0: one file
  std::uint64_t keep_files = 0;        // of a series; the oldest go; 0: all stay
  std::uint64_t spare_disk_bytes = 0;  // this much of the disk stays free: the oldest files of the series go, then the
                                       // recording ends
  bool overwrite = false;
};

class LogSeries {
 public:
  // Errors: kUnwritable; there is such a file, or such a series, already.
  [[nodiscard]] static Result<std::unique_ptr<LogSeries>> create(const SeriesSettings& settings);
  ~LogSeries();
  LogSeries(const LogSeries&) = delete;
  LogSeries& operator=(const LogSeries&) = delete;

  // `lost`: messages that did not come since the last one; the log's event numbers skip them. Errors: kUnwritable
  // (full, gone, ...); what was written before stays, whole.
  [[nodiscard]] Status write(const BusMessage& message, std::int64_t utime, std::uint64_t lost);
  // Onto the disk, now. Errors: as write().
  [[nodiscard]] Status flush();
  [[nodiscard]] Status close();

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }  // of all files, also of those that went
  [[nodiscard]] std::uint64_t files() const { return number_; }
  [[nodiscard]] const std::string& path() const { return path_; }  // of the newest file

 private:
  struct File;
  explicit LogSeries(SeriesSettings settings);
  [[nodiscard]] Status open_next();
  [[nodiscard]] Status close_file();
  [[nodiscard]] Status make_room();
  [[nodiscard]] Status broken(const std::string& why);

  SeriesSettings settings_;
  std::unique_ptr<File> file_;
  std::deque<std::string> kept_;
  std::string path_;
  std::uint64_t number_ = 0, bytes_ = 0;
};

}  // namespace rfmvo::record
