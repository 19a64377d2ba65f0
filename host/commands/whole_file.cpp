#include "commands/whole_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

namespace rfmvo {
namespace {

Error unwritable(const std::string& path, int error) {
  return {ErrorCode::kUnwritable, std::string("cannot write: ") + std::strerror(error), path};
}

// Everything to `descriptor`, and onto the disk; the errno of what failed, or 0.
int write_all(int descriptor, std::string_view content, bool sync) {
  while (!content.empty()) {
    const ssize_t n = ::write(descriptor, content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(n));
  }
  return sync && ::fsync(descriptor) != 0 ? errno : 0;
}

bool is_special(const std::string& path) {
  // /dev/stdout may lead to a regular file; the name itself must never be renamed over.
  if (path.starts_with("/dev/")) return true;
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

int write_special(const std::string& path, std::string_view content) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return errno;
  const int error = write_all(::fileno(file), content, false);
  std::fclose(file);
  return error;
}

}  // namespace

Result<WholeFile> WholeFile::stage(const std::string& path, std::string_view content) {
  if (is_special(path)) {
    const int error = write_special(path, content);
    if (error != 0) return unwritable(path, error);
    return WholeFile(path, "");
  }
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode)) return unwritable(path, EISDIR);

  std::string temporary = path + ".XXXXXX.tmp";
  const int descriptor = ::mkstemps(temporary.data(), 4);  // 4: the length of ".tmp"
  if (descriptor < 0) return unwritable(path, errno);
  // mkstemps makes the file private; a result is as readable as the user's mask says.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  int error = ::fchmod(descriptor, 0666 & ~mask) != 0 ? errno : 0;
  if (error == 0) error = write_all(descriptor, content, true);
  if (::close(descriptor) != 0 && error == 0) error = errno;
  WholeFile file(path, temporary);
  if (error != 0) return unwritable(path, error);
  return file;
}

WholeFile::WholeFile(std::string path, std::string temporary)
    : path_(std::move(path)), temporary_(std::move(temporary)) {}
WholeFile::WholeFile(WholeFile&& other) noexcept
    : path_(std::move(other.path_)), temporary_(std::exchange(other.temporary_, {})) {}
WholeFile& WholeFile::operator=(WholeFile&& other) noexcept {
  discard();
  path_ = std::move(other.path_);
  temporary_ = std::exchange(other.temporary_, {});
  return *this;
}
WholeFile::~WholeFile() { discard(); }

void WholeFile::discard() {
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

Status WholeFile::commit() {
  if (temporary_.empty()) return Done{};
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) return unwritable(path_, errno);
  temporary_.clear();
  return Done{};
}

Status write_whole_file(const std::string& path, std::string_view content) {
  Result<WholeFile> file = WholeFile::stage(path, content);
  if (!file) return file.error();
  WholeFile staged = std::move(file).value();
  return staged.commit();
}

Result<std::string> read_whole_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  if (file) content << file.rdbuf();
  if (!file || file.bad()) {
    return Error{ErrorCode::kUnreadable, std::string("cannot read: ") + std::strerror(errno), path};
  }
  return content.str();
}

}  // namespace rfmvo
