#include "edges/log_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace rfmvo {
namespace {

constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
constexpr std::size_t kHeaderBytes = 28;
constexpr std::size_t kMaxChannelBytes = 63;                     // LCM_MAX_CHANNEL_NAME_LENGTH
constexpr std::int64_t kMaxDataBytes = std::int64_t{1} << 28;  // 256 MB; our own messages stay below 128 MB

using Header = std::array<std::uint8_t, kHeaderBytes>;

template <std::size_t Bytes>
void put(Header& header, std::size_t offset, std::uint64_t value) {
  for (std::size_t i = 0; i < Bytes; ++i) header[offset + i] = static_cast<std::uint8_t>(value >> (8 * (Bytes - 1 - i)));
}

template <std::size_t Bytes>
std::uint64_t get(const Header& header, std::size_t offset) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < Bytes; ++i) value = value << 8 | header[offset + i];
  return value;
}

Header header_of(std::int64_t number, std::int64_t utime, std::size_t channel_bytes, std::size_t data_bytes) {
  Header header{};
  put<4>(header, 0, kSyncWord);
  put<8>(header, 4, static_cast<std::uint64_t>(number));
  put<8>(header, 12, static_cast<std::uint64_t>(utime));
  put<4>(header, 20, channel_bytes);
  put<4>(header, 24, data_bytes);
  return header;
}

std::string temporary_of(const std::string& path) { return path + ".tmp"; }

Error unwritable(const std::string& path, const std::string& why) {
  return {ErrorCode::kUnwritable, "cannot be written: " + why, path};
}

// A rename is only on the disk when its folder is.
void sync_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const int fd = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  (void)::fsync(fd);
  ::close(fd);
}

}  // namespace

void append_log_record(std::vector<std::uint8_t>& out, std::int64_t number, std::int64_t utime,
                       std::string_view channel, std::span<const std::uint8_t> data) {
  RFMVO_ASSERT(!channel.empty() && channel.size() <= kMaxChannelBytes);
  const Header header = header_of(number, utime, channel.size(), data.size());
  out.insert(out.end(), header.begin(), header.end());
  out.insert(out.end(), channel.begin(), channel.end());
  out.insert(out.end(), data.begin(), data.end());
}

Result<std::unique_ptr<LogFileWriter>> LogFileWriter::create(const std::string& path) {
  std::error_code ignored;
  if (path.empty() || std::filesystem::is_directory(path, ignored)) return unwritable(path, "it is a folder, not a file");
  const int fd = ::open(temporary_of(path).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0) return unwritable(path, std::strerror(errno));
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd);
    return unwritable(path, "another program is writing it");
  }
  std::FILE* file = ::ftruncate(fd, 0) == 0 ? ::fdopen(fd, "wb") : nullptr;
  if (file == nullptr) {
    const std::string why = std::strerror(errno);
    ::close(fd);
    return unwritable(path, why);
  }
  return std::unique_ptr<LogFileWriter>(new LogFileWriter(path, file));
}

LogFileWriter::~LogFileWriter() {
  if (file_ == nullptr) return;
  (void)::unlink(temporary_of(path_).c_str());
  (void)std::fclose(file_);
}

Status LogFileWriter::write(std::string_view channel, std::int64_t utime, std::span<const std::uint8_t> data) {
  RFMVO_ASSERT(file_ != nullptr && !channel.empty());
  if (channel.size() > kMaxChannelBytes)
    return Error{ErrorCode::kOutOfRange, "channel name is longer than 63 bytes", std::string(channel)};
  const Header header = header_of(count_, utime, channel.size(), data.size());
  const bool written = std::fwrite(header.data(), 1, header.size(), file_) == header.size() &&
                       std::fwrite(channel.data(), 1, channel.size(), file_) == channel.size() &&
                       std::fwrite(data.data(), 1, data.size(), file_) == data.size();
  if (!written) return unwritable(path_, std::strerror(errno));
  ++count_;
  return Done{};
}

Status LogFileWriter::close() {
  RFMVO_ASSERT(file_ != nullptr);
  const bool flushed = std::fflush(file_) == 0 && ::fsync(::fileno(file_)) == 0;
  if (!flushed || std::rename(temporary_of(path_).c_str(), path_.c_str()) != 0)
    return unwritable(path_, std::strerror(errno));  // the destructor removes the temporary file
  (void)std::fclose(file_);
  file_ = nullptr;
  sync_folder_of(path_);
  return Done{};
}

Result<std::unique_ptr<LogFileReader>> LogFileReader::open(const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "rbe");
  if (file == nullptr) {
    const bool missing = errno == ENOENT || errno == ENOTDIR;
    return Error{missing ? ErrorCode::kNotFound : ErrorCode::kUnreadable,
                 missing ? "no such file" : std::string("cannot be read: ") + std::strerror(errno), path};
  }
  struct stat info{};
  if (::fstat(::fileno(file), &info) != 0 || !S_ISREG(info.st_mode)) {
    (void)std::fclose(file);
    return Error{ErrorCode::kUnreadable, "not a regular file", path};
  }
  std::unique_ptr<LogFileReader> reader(new LogFileReader(path, file, info.st_size));
  if (info.st_size == 0) return Error{ErrorCode::kMalformed, "an empty file, not an LCM log", path};
  return reader;
}

LogFileReader::~LogFileReader() { (void)std::fclose(file_); }

std::string LogFileReader::where(std::int64_t offset) const { return path_ + ": byte " + std::to_string(offset); }

Result<std::optional<LogRecord>> LogFileReader::next(bool with_data) {
  const std::int64_t left = size_ - offset_;
  if (left == 0) return std::optional<LogRecord>();
  const auto truncated = [&] {
    return Error{ErrorCode::kMalformed, "truncated: the record that starts here is not whole", where(offset_)};
  };
  Header header{};
  const std::size_t got = std::fread(header.data(), 1, header.size(), file_);
  if (got >= 4 && get<4>(header, 0) != kSyncWord)
    return Error{ErrorCode::kMalformed, "not an LCM log: no record starts here (sync word missing)", where(offset_)};
  if (got < header.size()) return truncated();
  const auto channel_bytes = static_cast<std::int32_t>(get<4>(header, 20));
  const auto data_bytes = static_cast<std::int32_t>(get<4>(header, 24));
  if (channel_bytes < 1 || static_cast<std::size_t>(channel_bytes) > kMaxChannelBytes || data_bytes < 0 ||
      data_bytes > kMaxDataBytes)
    return Error{ErrorCode::kMalformed, "damaged: a record's length is out of range", where(offset_)};
  const std::int64_t record_bytes = static_cast<std::int64_t>(kHeaderBytes) + channel_bytes + data_bytes;
  if (record_bytes > left) return truncated();
  LogRecord record;
  record.offset = offset_;
  record.number = static_cast<std::int64_t>(get<8>(header, 4));
  record.utime = static_cast<std::int64_t>(get<8>(header, 12));
  record.channel.resize(static_cast<std::size_t>(channel_bytes));
  bool whole = std::fread(record.channel.data(), 1, record.channel.size(), file_) == record.channel.size();
  if (with_data) {
    record.data.resize(static_cast<std::size_t>(data_bytes));
    whole = whole && std::fread(record.data.data(), 1, record.data.size(), file_) == record.data.size();
  } else {
    whole = whole && ::fseeko(file_, data_bytes, SEEK_CUR) == 0;
  }
  if (!whole) return truncated();
  offset_ += record_bytes;
  return std::optional(std::move(record));
}

}  // namespace rfmvo
