#include "manual/manual.hpp"

#include <fmt/format.h>

#include "commands/commands.hpp"

namespace rfmvo {

void add_manual_commands(CLI::App& app) {
  app.footer(std::string("Exit codes: ") + manual::kExitCodes + ".");
  app.add_subcommand("man", "Print this manual as a man page: rfmvo man | man -l -")->callback([&app] {
    fmt::print("{}", manual::man_page(app, RFMVO_VERSION));
  });
  app.add_subcommand("completion", "Print the completion for bash: source <(rfmvo completion)")->callback([&app] {
    fmt::print("{}", manual::bash_completion(app));
  });
}

}  // namespace rfmvo
