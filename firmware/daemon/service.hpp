// rfmvod's work: one run after the other, until it is told to stop. A run has one configuration; a reload that changes
// more than what can change live begins a new one.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "config/config.hpp"

namespace rfmvo {

struct Options {
  std::string config;
  std::string journal;                // overrides journal.directory
  std::string result;                 // what was published, as a result log
  std::string settings_file;          // what is set at run time is kept here, over the configuration
  std::vector<std::string> settings;  // "section.key=value", over both
};

// The configuration file, what was set at run time, the command line: the later ones win.
[[nodiscard]] Result<Config> load_config(const Options& options);
[[nodiscard]] Status serve(const Options& options);

}  // namespace rfmvo
