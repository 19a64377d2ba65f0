// The bus into a recording: one thread listens, the caller's thread writes, so that a slow disk costs no message
// as long as the queue has room.
#pragma once

#include <functional>
#include <map>
#include <regex>

#include "bus/bus_listener.hpp"
#include "inspect/sequence.hpp"
#include "record/log_series.hpp"

namespace rfmvo::record {

struct RecorderSettings {
  std::regex channels{".*"};  // the whole name must match
  bool invert = false;        // record those that do not match
  Duration flush_interval{Duration::from_seconds(0.5)};
  Duration length{0};  // 0: until stop() says so
};

struct ChannelCount {
  std::uint64_t messages = 0, bytes = 0;
};

struct RecorderFigures {
  std::uint64_t messages = 0;
  Duration length{0};
  BusLoss loss;  // of all channels, recorded or not
  std::map<std::string, ChannelCount> channels;
  inspect::SequenceLoss sequences;  // of messages that count themselves
};

// Until stop() or the length: then what has arrived is written, too. `watch` is called about once a second. Errors: of
// the bus, of the disk; `figures` says what was recorded until then.
[[nodiscard]] Status record(BusListener& bus, LogSeries& log, const RecorderSettings& settings,
                            const std::function<bool()>& stop, const std::function<void(const RecorderFigures&)>& watch,
                            RecorderFigures& figures);

}  // namespace rfmvo::record
