// Small hand-made values and files for tests of the edges.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "edges/event_io.hpp"

namespace rfmvo::testing {

// A folder of its own for each test; gone when the test ends.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::vector<std::string> names() const;  // of everything in it, sorted

 private:
  std::filesystem::path path_;
};

[[nodiscard]] std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& bytes);

[[nodiscard]] Calibration sample_calibration();
[[nodiscard]] Start sample_start();
// One of each event, with awkward numbers. Frames: 8 x 6 px grey8.
[[nodiscard]] std::vector<Event> one_of_each_event();
[[nodiscard]] std::vector<Estimate> one_of_each_estimate();
// Start, then camera poses at 10 Hz along a straight line and reads of two tags between them.
[[nodiscard]] std::vector<Event> short_run(int poses);

void write_journal(const std::string& path, const std::vector<Event>& events);

// Runs a command by the shell; its output and exit code.
struct CommandResult {
  int exit_code = -1;
  std::string out;
  std::string err;
};
[[nodiscard]] CommandResult run_command(const std::string& command);

}  // namespace rfmvo::testing
