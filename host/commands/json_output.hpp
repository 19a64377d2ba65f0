// `--json [FILE]`, the same for every subcommand that has it: the numbers as JSON into FILE; without FILE, or with "-",
// on stdout instead of the text.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace rfmvo {

class JsonOutput {
 public:
  // `this`, and `force`, must outlive the parsing. Without `force` the command gets a --force for FILE.
  void add_to(CLI::App& command, const bool* force = nullptr);
  [[nodiscard]] bool on_stdout() const { return path_ == "-"; }
  // Nothing if nobody asked.
  [[nodiscard]] Status write(std::string_view json) const;

 private:
  std::string path_;
  bool own_force_ = false;
  const bool* force_ = &own_force_;
};

}  // namespace rfmvo
