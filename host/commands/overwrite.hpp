// Nothing is overwritten unless --force says so.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace rfmvo {

// --force. `force` must outlive the parsing.
void add_force_option(CLI::App& command, bool& force);

// Errors: kUnwritable naming the first of the files that is there. Empty names, and what is no regular file
// (/dev/stdout, a pipe), are always free.
[[nodiscard]] Status check_free(const std::vector<std::string>& paths, bool force);

}  // namespace rfmvo
