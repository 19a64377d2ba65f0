#include "commands/overwrite.hpp"

#include <filesystem>

namespace rfmvo {

void add_force_option(CLI::App& command, bool& force) {
  command.add_flag("--force", force, "Overwrite files that are there");
}

Status check_free(const std::vector<std::string>& paths, bool force) {
  std::error_code ignored;
  for (const std::string& path : paths)
    if (!force && !path.empty() && !path.starts_with("/dev/") && std::filesystem::is_regular_file(path, ignored))
      return Error{ErrorCode::kUnwritable, "is there already; --force overwrites it", path};
  return Done{};
}

}  // namespace rfmvo
