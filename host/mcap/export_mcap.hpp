// A journal, a result, or both, as one MCAP file for Foxglove.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace rfmvo::mcap {

struct McapFigures {
  std::uint64_t messages = 0, images = 0, tags = 0;
};

// Topics: /tf (map to camera), /tags and /path (scenes), /camera/image, /camera/calibration, /log (faults, corrections
// of the map, changes of health). `logs` are read one after the other; `watch` is told how many bytes so far. Errors:
// as the log reader; kUnwritable; kNotFound if none of the logs holds anything of ours.
[[nodiscard]] Result<McapFigures> export_mcap(const std::vector<std::string>& logs, const std::string& prefix,
                                              const std::string& path,
                                              const std::function<void(std::int64_t)>& watch = {});

}  // namespace rfmvo::mcap
