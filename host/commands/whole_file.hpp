// Files that appear whole or not at all: written under a temporary name beside the target, renamed by
// commit(), removed if that never comes.
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"

namespace rfmvo {

class WholeFile {
 public:
  // Writes all of `content` under the temporary name. A target that exists and is no regular file
  // (/dev/stdout, a pipe) is written at once. Errors: kUnwritable naming the target.
  [[nodiscard]] static Result<WholeFile> stage(const std::string& path, std::string_view content);

  WholeFile(WholeFile&& other) noexcept;
  WholeFile& operator=(WholeFile&& other) noexcept;
  ~WholeFile();

  [[nodiscard]] Status commit();

 private:
  WholeFile(std::string path, std::string temporary);
  void discard();

  std::string path_;
  std::string temporary_;  // empty: nothing left to do
};

[[nodiscard]] Status write_whole_file(const std::string& path, std::string_view content);
[[nodiscard]] Result<std::string> read_whole_file(const std::string& path);

}  // namespace rfmvo
