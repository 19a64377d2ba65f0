#include "edges/text_file.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace rfmvo {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 24;

}  // namespace

Result<std::string> read_text_file(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"), &std::fclose);
  if (file == nullptr) {
    const bool missing = errno == ENOENT || errno == ENOTDIR;
    return Error{missing ? ErrorCode::kNotFound : ErrorCode::kUnreadable,
                 missing ? "no such file" : std::string("cannot be read: ") + std::strerror(errno), path};
  }
  std::string text;
  std::array<char, 65536> chunk{};
  while (text.size() <= kMaxBytes) {
    const std::size_t got = std::fread(chunk.data(), 1, chunk.size(), file.get());
    if (got == 0) break;
    text.append(chunk.data(), got);
  }
  if (std::ferror(file.get()) != 0)
    return Error{ErrorCode::kUnreadable, std::string("cannot be read: ") + std::strerror(errno), path};
  if (text.size() > kMaxBytes) return Error{ErrorCode::kMalformed, "larger than 16 MB", path};
  return text;
}

}  // namespace rfmvo
