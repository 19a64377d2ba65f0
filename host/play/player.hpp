// Logs played back: their records, each when its time has come. The door is where time, keys and the bus are.
#pragma once

#include <cstdint>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "edges/log_file.hpp"

namespace rfmvo::play {

enum class Key { kNone, kPause, kStep, kQuit };

class PlayDoor {
 public:
  virtual ~PlayDoor() = default;
  [[nodiscard]] virtual std::int64_t now_ns() = 0;  // of a clock without steps
  // Waits until then, or until a key is pressed. kNone: the time has come.
  [[nodiscard]] virtual Key wait_until(std::int64_t ns) = 0;
  // `position`: of the record, since the beginning of the log.
  [[nodiscard]] virtual Status send(const LogRecord& record, Duration position) = 0;
};

inline constexpr std::int64_t kForever_ns = std::numeric_limits<std::int64_t>::max();

struct PlaySettings {
  double speed = 1.0;                 // log seconds a second
  Duration from{0}, to{kForever_ns};  // since the first record; both included
  std::regex channels{".*"};          // the whole name must match
  bool loop = false;
  bool paused = false;  // at the beginning
};

struct PlayFigures {
  std::uint64_t sent = 0, rounds = 0;
};

// To the end of the log (never, if it loops) or a kQuit. A pause stops the log's time; a step sends the next record at
// once and pauses. Errors: of the log reader; of send(); kNotFound if there is no record to send.
[[nodiscard]] Result<PlayFigures> play(const std::vector<std::string>& logs, const PlaySettings& settings,
                                       PlayDoor& door);

}  // namespace rfmvo::play
