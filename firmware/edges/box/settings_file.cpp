#include "edges/box/settings_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "edges/net/fd.hpp"
#include "edges/text_file.hpp"
#include "edges/toml_files.hpp"
#include "edges/toml_parts.hpp"

namespace rfmvo {
namespace {

// The rows in which the two differ, as TOML.
std::string difference(const Config& base, const Config& changed) {
  std::string out = "# Set at run time, over the configuration file.\n";
  std::string_view section;
  for (const ConfigRow& row : config_rows()) {
    const ConfigValue value = get_value(changed, row);
    if (value == get_value(base, row)) continue;
    const std::size_t dot = row.key.find('.');
    if (row.key.substr(0, dot) != section) {
      section = row.key.substr(0, dot);
      out += "\n[" + std::string(section) + "]\n";
    }
    out += std::string(row.key.substr(dot + 1)) + " = " +
           std::visit([](const auto& v) { return toml_parts::text_of(v); }, value) + "\n";
  }
  return out;
}

Error unwritable(const std::string& path, int error) {
  return {ErrorCode::kUnwritable, std::string("cannot be written: ") + std::strerror(error), path};
}

}  // namespace

std::string text_of(const ConfigValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return std::visit([](const auto& v) { return toml_parts::text_of(v); }, value);
}

Status write_file_atomically(const std::string& path, std::string_view text) {
  const std::string temporary = path + ".new";
  {
    const net::Fd fd(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0640));
    if (!fd.valid()) return unwritable(path, errno);
    const bool written = ::write(fd.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
    if (!written || ::fsync(fd.get()) != 0) {
      const int error = errno;
      (void)::unlink(temporary.c_str());
      return unwritable(path, error);
    }
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    const int error = errno;
    (void)::unlink(temporary.c_str());
    return unwritable(path, error);
  }
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const net::Fd fd(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.valid()) (void)::fsync(fd.get());
  return Done{};
}

Result<Config> SettingsFile::over(const Config& base) const {
  std::error_code ignored;
  if (path_.empty() || !std::filesystem::exists(path_, ignored)) return base;
  return read_config(path_, base);
}

Result<Config> SettingsFile::set(const Config& base, std::string_view key, std::string_view value) const {
  if (path_.empty()) return Error{ErrorCode::kUnsupported, "this program was started without --settings", "settings"};
  auto present = over(base);
  if (!present) return present.error();
  Config changed = std::move(present).value();
  if (const Status s = set_value_from_text(changed, key, value); !s) return s.error();
  if (const Status s = check_consistency(changed); !s) return s.error();
  if (const Status s = write_file_atomically(path_, difference(base, changed)); !s) return s.error();
  return over(base);
}

}  // namespace rfmvo
