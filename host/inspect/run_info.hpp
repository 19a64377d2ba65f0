// What a log holds, from one pass over it: any LCM log, journal or result.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "estimator/event.hpp"

namespace rfmvo::inspect {

struct ChannelInfo {
  std::string type;  // of the first message; empty: not one of ours
  std::uint64_t messages = 0, bytes = 0;
  std::int64_t first_us = 0, last_us = 0;
  double longest_gap_s = 0.0;          // between two messages
  std::int64_t longest_gap_at_us = 0;  // when it began
  std::optional<std::int64_t> lost;    // by the sender's own counter; nothing if the messages have none

  // Messages a second between the first and the last; 0 if that is no time.
  [[nodiscard]] double rate_hz() const;
};

struct StartInfo {
  std::string version;           // of the program that wrote it
  std::optional<Start> content;  // nothing: of a version whose keys this one does not know
  std::string problem;           // then: why
};

struct RunInfo {
  std::uint64_t messages = 0, bytes = 0;
  std::int64_t first_us = 0, last_us = 0;
  std::int64_t lost_by_recorder = 0;  // gaps of the log's own event numbers
  std::map<std::string, ChannelInfo> channels;
  std::optional<StartInfo> start;
  std::vector<Fault> faults;
  std::optional<ReaderStatus> reader;  // the last one
  std::optional<Error> damage;         // what there is, is told; and that it ends too early

  [[nodiscard]] double duration_s() const { return static_cast<double>(last_us - first_us) * 1e-6; }
};

// Errors: the file cannot be read, or is no log from its first byte on.
[[nodiscard]] Result<RunInfo> read_run_info(const std::string& path, const std::string& prefix);

[[nodiscard]] std::string to_text(const RunInfo& info, const std::string& path);
[[nodiscard]] std::string to_json(const RunInfo& info, const std::string& path);

}  // namespace rfmvo::inspect
