// The built `rfmvo` as a user calls it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "support/sample_events.hpp"

namespace rfmvo::testing {

[[nodiscard]] inline CommandResult rfmvo(const std::string& arguments) {
  return run_command(RFMVO_COMMAND " " + arguments);
}

[[nodiscard]] inline std::string in_quotes(const std::string& path) { return "'" + path + "'"; }

// One clear line on stderr that contains `culprit`.
inline void expect_one_line(const CommandResult& result, const std::string& culprit, int exit_code = 1) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(culprit), std::string::npos) << result.err << "does not name " << culprit;
}

}  // namespace rfmvo::testing
