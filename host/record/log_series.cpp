#include "record/log_series.hpp"

#include <fmt/format.h>
#include <lcm/eventlog.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "edges/log_file.hpp"

namespace rfmvo::record {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kRecordHeader = 28;  // of an LCM log
// The disk is asked for its free space when this much has been written since.
constexpr std::uint64_t kAskAfterBytes = 4 << 20;

std::string numbered(const std::string& path, std::uint64_t number) {
  const fs::path whole(path);
  return (whole.parent_path() / fmt::format("{}-{:05}{}", whole.stem().string(), number, whole.extension().string()))
      .string();
}

// Files of an earlier series under the same name.
std::vector<fs::path> earlier_files(const std::string& path) {
  const fs::path whole(path);
  std::vector<fs::path> found;
  std::error_code ignored;
  const fs::path folder = whole.parent_path().empty() ? fs::path(".") : whole.parent_path();
  const std::string stem = whole.stem().string() + "-", extension = whole.extension().string();
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(stem) || !name.ends_with(extension) || name.size() < stem.size() + extension.size()) continue;
    const std::string number = name.substr(stem.size(), name.size() - stem.size() - extension.size());
    if (number.size() >= 5 && number.find_first_not_of("0123456789") == std::string::npos)
      found.push_back(entry.path());
  }
  return found;
}

// The bytes of whole records at the front of a log.
std::uint64_t whole_bytes(const std::string& path) {
  const auto reader = LogFileReader::open(path);
  std::uint64_t end = 0;
  while (reader) {
    const auto record = reader.value()->next();
    if (!record || !record.value()) break;
    end = static_cast<std::uint64_t>(record.value()->offset) + kRecordHeader + record.value()->channel.size() +
          record.value()->data.size();
  }
  return end;
}

}  // namespace

struct LogSeries::File {
  explicit File(lcm_eventlog_t* opened) : log(opened) {}
  ~File() { lcm_eventlog_destroy(log); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  lcm_eventlog_t* log;
  std::uint64_t bytes = 0, asked_at = 0;
};

LogSeries::LogSeries(SeriesSettings settings) : settings_(std::move(settings)) {}
LogSeries::~LogSeries() = default;

Result<std::unique_ptr<LogSeries>> LogSeries::create(const SeriesSettings& settings) {
  std::error_code ignored;
  const auto earlier = settings.split_bytes > 0 ? earlier_files(settings.path) : std::vector<fs::path>();
  const bool there = settings.split_bytes > 0 ? !earlier.empty() : fs::exists(settings.path, ignored);
  if (there && !settings.overwrite)
    return Error{ErrorCode::kUnwritable, "is there already; --force overwrites it",
                 earlier.empty() ? settings.path : earlier.front().string()};
  for (const fs::path& file : earlier) fs::remove(file, ignored);
  std::unique_ptr<LogSeries> series(new LogSeries(settings));
  if (const Status s = series->open_next(); !s) return s.error();
  return series;
}

Status LogSeries::open_next() {
  const std::string path = settings_.split_bytes > 0 ? numbered(settings_.path, number_ + 1) : settings_.path;
  errno = 0;
  lcm_eventlog_t* log = lcm_eventlog_create(path.c_str(), "w");
  if (log == nullptr)
    return Error{ErrorCode::kUnwritable,
                 std::string("cannot be written: ") + (errno != 0 ? std::strerror(errno) : "no reason given"), path};
  file_ = std::make_unique<File>(log);
  path_ = path;
  ++number_;
  kept_.push_back(path);
  std::error_code ignored;
  while (settings_.keep_files > 0 && kept_.size() > settings_.keep_files) {
    fs::remove(kept_.front(), ignored);
    kept_.pop_front();
  }
  return Done{};
}

// The cause is said; half a record at the end is cut off.
Status LogSeries::broken(const std::string& why) {
  file_.reset();
  (void)::truncate(path_.c_str(), static_cast<off_t>(whole_bytes(path_)));
  return Error{ErrorCode::kUnwritable, why, path_};
}

Status LogSeries::make_room() {
  if (settings_.spare_disk_bytes == 0 || file_->bytes < file_->asked_at) return Done{};
  std::error_code error;
  while (fs::space(path_, error).available < settings_.spare_disk_bytes && !error) {
    if (kept_.size() <= 1) return broken("the disk is as full as it may get (--disk-quota-mb); recording ends");
    fs::remove(kept_.front(), error);
    kept_.pop_front();
  }
  file_->asked_at = file_->bytes + kAskAfterBytes;
  return Done{};
}

Status LogSeries::write(const BusMessage& message, std::int64_t utime, std::uint64_t lost) {
  RFMVO_ASSERT(file_ != nullptr);
  const std::uint64_t size = kRecordHeader + message.channel.size() + message.data.size();
  if (settings_.split_bytes > 0 && file_->bytes > 0 && file_->bytes + size > settings_.split_bytes) {
    if (Status s = close_file(); !s) return s;
    if (Status s = open_next(); !s) return s;
  }
  if (Status s = make_room(); !s) return s;
  std::string channel = message.channel;
  std::vector<std::uint8_t> data = message.data;
  lcm_eventlog_event_t event{0,
                             utime,
                             static_cast<std::int32_t>(channel.size()),
                             static_cast<std::int32_t>(data.size()),
                             channel.data(),
                             data.data()};
  file_->log->eventcount += static_cast<std::int64_t>(lost);
  errno = 0;
  if (lcm_eventlog_write_event(file_->log, &event) != 0)
    return broken(std::string("cannot be written: ") + std::strerror(errno));
  file_->bytes += size;
  bytes_ += size;
  return Done{};
}

Status LogSeries::flush() {
  RFMVO_ASSERT(file_ != nullptr);
  if (std::fflush(file_->log->f) == 0 && ::fdatasync(::fileno(file_->log->f)) == 0) return Done{};
  return broken(std::string("cannot be written: ") + std::strerror(errno));
}

Status LogSeries::close_file() {
  if (Status s = flush(); !s) return s;
  file_.reset();
  return Done{};
}

Status LogSeries::close() { return close_file(); }

}  // namespace rfmvo::record
