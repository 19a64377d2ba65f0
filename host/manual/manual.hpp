// The manual of a command line, made of the parser itself: what is added there is in here.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

namespace rfmvo::manual {

// What the programs say by their exit code.
inline constexpr const char* kExitCodes =
    "0 done; 1 it failed: one line on stderr names the file, key, offset or address; 2 the command line is wrong; "
    "3 the answer is no (diff: the two differ; status --once: the box is not well)";

// Every subcommand that does something, with its whole name: "log", "calibrate camera".
[[nodiscard]] std::vector<std::pair<std::string, const CLI::App*>> commands_of(const CLI::App& app);

// roff, section 1.
[[nodiscard]] std::string man_page(const CLI::App& app, const std::string& version);

// To be sourced by bash: subcommands, their options, the choices of an option, otherwise files.
[[nodiscard]] std::string bash_completion(const CLI::App& app);

}  // namespace rfmvo::manual
