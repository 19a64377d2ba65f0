#include "edges/recorder/segment_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "edges/log_file.hpp"

namespace rfmvo {
namespace {

namespace fs = std::filesystem;

// A name is only on the disk when its folder is.
void sync_folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  const net::Fd fd(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.valid()) (void)::fsync(fd.get());
}

// All of it, or an errno.
int write_all(int fd, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return EIO;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

// How much of the file is whole records.
Recovered whole_part(const std::string& path) {
  Recovered whole{path, 0, 0, 0};
  auto file = LogFileReader::open(path);
  if (!file) return whole;
  while (true) {
    auto record = file.value()->next(false);
    if (!record || !record.value()) break;
    ++whole.records;
    whole.bytes = file.value()->offset();
  }
  return whole;
}

}  // namespace

Error SegmentFile::trouble(int error) const {
  return {ErrorCode::kUnwritable, std::string("cannot be written: ") + std::strerror(error), name_.path()};
}

Result<SegmentFile> SegmentFile::create(const SegmentName& name) {
  SegmentName unfinished = name;
  unfinished.unfinished = true;
  const std::string path = unfinished.path_on_disk();
  SegmentFile file(unfinished, net::Fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644)));
  if (!file.fd_.valid()) return file.trouble(errno);
  if (::flock(file.fd_.get(), LOCK_EX | LOCK_NB) != 0) return file.trouble(errno);
  sync_folder_of(path);
  return file;
}

Status SegmentFile::append(std::span<const std::uint8_t> records) {
  const int error = write_all(fd_.get(), records);
  disk_was_full_ = error == ENOSPC || error == EDQUOT;
  if (error == 0) {
    bytes_ += static_cast<std::int64_t>(records.size());
    return Done{};
  }
  // Half a record would hide all that follow.
  if (::ftruncate(fd_.get(), bytes_) != 0) return trouble(errno);
  return trouble(error);
}

Status SegmentFile::sync() {
  if (::fdatasync(fd_.get()) != 0) return trouble(errno);
  return Done{};
}

Status SegmentFile::finish() {
  if (const Status s = sync(); !s) return s;
  if (::rename(name_.path_on_disk().c_str(), name_.path().c_str()) != 0) return trouble(errno);
  sync_folder_of(name_.path());
  name_.unfinished = false;
  return Done{};
}

std::vector<Recovered> recover_segments(const std::string& folder) {
  std::vector<Recovered> recovered;
  std::error_code ignored;
  std::vector<SegmentName> unfinished;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    auto name = segment_name(entry->path().string());
    if (name && name->unfinished) unfinished.push_back(*std::move(name));
  }
  std::sort(unfinished.begin(), unfinished.end());
  for (const SegmentName& name : unfinished) {
    const std::string path = name.path_on_disk();
    const net::Fd fd(::open(path.c_str(), O_RDWR | O_CLOEXEC));
    if (!fd.valid() || ::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) continue;
    const auto size = static_cast<std::int64_t>(fs::file_size(path, ignored));
    Recovered whole = whole_part(path);
    whole.bytes_cut = size - whole.bytes;
    whole.path = name.path();
    if (whole.records == 0) {
      fs::remove(path, ignored);
    } else if (::ftruncate(fd.get(), whole.bytes) != 0 || ::fsync(fd.get()) != 0 || fs::exists(name.path(), ignored) ||
               ::rename(path.c_str(), name.path().c_str()) != 0) {
      continue;  // a card that cannot be written: it stays readable as it is
    }
    recovered.push_back(std::move(whole));
  }
  if (!recovered.empty()) sync_folder_of(folder + "/.");
  return recovered;
}

}  // namespace rfmvo
