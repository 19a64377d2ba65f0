#include "commands/json_output.hpp"

#include <cstdio>

#include "commands/overwrite.hpp"
#include "commands/whole_file.hpp"

namespace rfmvo {

void JsonOutput::add_to(CLI::App& command, const bool* force) {
  if (force != nullptr)
    force_ = force;
  else
    add_force_option(command, own_force_);
  command
      .add_option_function<std::vector<std::string>>(
          "--json", [this](const std::vector<std::string>& files) { path_ = files.front(); },
          "Write the numbers as JSON to FILE; without FILE to stdout, instead of the text")
      ->expected(0, 1)
      ->default_str("-")
      ->type_name("[FILE]");
}

Status JsonOutput::write(std::string_view json) const {
  if (path_.empty()) return Done{};
  if (const Status s = check_free({on_stdout() ? "" : path_}, *force_); !s) return s;
  if (!on_stdout()) return write_whole_file(path_, json);
  const bool written = std::fwrite(json.data(), 1, json.size(), stdout) == json.size() && std::fflush(stdout) == 0;
  if (written) return Done{};
  return Error{ErrorCode::kUnwritable, "cannot be written", "stdout"};
}

}  // namespace rfmvo
