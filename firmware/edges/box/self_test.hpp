// What can be wrong before anything runs, in words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "config/calibration.hpp"
#include "config/config.hpp"
#include "edges/box/machine.hpp"

namespace rfmvo {

struct Check {
  std::string part;  // "camera", "reader", ...
  bool ok = false;
  std::string text;
};

[[nodiscard]] Check check_clock(const SystemClock& clock);
[[nodiscard]] Check check_bus(const LcmConfig& config);
[[nodiscard]] Check check_journal(const JournalConfig& config);
[[nodiscard]] Check check_camera(const CameraConfig& config);  // starts it, takes a picture
[[nodiscard]] Check check_reader(const ReaderConfig& config);  // connects; up to 2 s per address

// All of them; takes seconds.
[[nodiscard]] std::vector<Check> self_test(const Config& config);

}  // namespace rfmvo
