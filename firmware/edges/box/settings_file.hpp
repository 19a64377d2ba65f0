// What has been set at run time: a small TOML file over the configuration, which stays as its owner wrote it.
#pragma once

#include <string>
#include <string_view>

#include "config/config.hpp"
#include "config/config_table.hpp"

namespace rfmvo {

[[nodiscard]] std::string text_of(const ConfigValue& value);  // as `--set` takes it

class SettingsFile {
 public:
  explicit SettingsFile(std::string path) : path_(std::move(path)) {}

  // `base` with the file's settings over it; `base` itself if there is no file.
  [[nodiscard]] Result<Config> over(const Config& base) const;
  // Checked by the configuration table together with all others, written whole or not at all (kept through a power
  // failure), and read back: what is returned is what the file says.
  [[nodiscard]] Result<Config> set(const Config& base, std::string_view key, std::string_view value) const;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// Replaces the file in one step. Errors: kUnwritable.
[[nodiscard]] Status write_file_atomically(const std::string& path, std::string_view text);

}  // namespace rfmvo
