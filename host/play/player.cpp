#include "play/player.hpp"

#include "play/merged_logs.hpp"

namespace rfmvo::play {
namespace {

// The log's time against the door's clock: at `clock_ns` it was `log_ns`.
struct Pace {
  std::int64_t clock_ns = 0, log_ns = 0;
  double speed = 1.0;

  [[nodiscard]] std::int64_t due_ns(std::int64_t position_ns) const {
    return clock_ns + static_cast<std::int64_t>(static_cast<double>(position_ns - log_ns) / speed);
  }
};

class Round {
 public:
  Round(const PlaySettings& settings, PlayDoor& door, PlayFigures& figures, bool& paused)
      : settings_(settings), door_(door), figures_(figures), paused_(paused) {
    pace_ = {door.now_ns(), settings.from.ns, settings.speed};
  }

  // False: someone wants to quit.
  Result<bool> on(const LogRecord& record) {
    if (!begun_) first_us_ = record.utime;
    begun_ = true;
    const Duration position{(record.utime - first_us_) * 1000};
    if (position < settings_.from || position > settings_.to) return true;
    if (!std::regex_match(record.channel, settings_.channels)) return true;
    if (!wait_for(position.ns)) return false;
    if (const Status s = door_.send(record, position); !s) return s.error();
    ++figures_.sent;
    return true;
  }

 private:
  bool wait_for(std::int64_t position_ns) {
    while (true) {
      const Key key = door_.wait_until(paused_ ? kForever_ns : pace_.due_ns(position_ns));
      if (key == Key::kQuit) return false;
      if (key == Key::kNone && !paused_) return true;
      if (key == Key::kPause) paused_ = !paused_;
      if (key == Key::kPause || key == Key::kStep) pace_ = {door_.now_ns(), position_ns, settings_.speed};
      if (key != Key::kStep) continue;
      paused_ = true;
      return true;
    }
  }

  const PlaySettings& settings_;
  PlayDoor& door_;
  PlayFigures& figures_;
  bool& paused_;
  bool begun_ = false;
  std::int64_t first_us_ = 0;
  Pace pace_;
};

}  // namespace

Result<PlayFigures> play(const std::vector<std::string>& logs, const PlaySettings& settings, PlayDoor& door) {
  PlayFigures figures;
  bool paused = settings.paused;
  do {
    auto opened = MergedLogs::open(logs);
    if (!opened) return opened.error();
    MergedLogs merged = std::move(opened).value();
    Round round(settings, door, figures, paused);
    while (true) {
      const auto record = merged.next();
      if (!record) return record.error();
      if (!record.value()) break;
      const auto more = round.on(*record.value());
      if (!more) return more.error();
      if (!more.value()) return figures;
    }
    ++figures.rounds;
    if (figures.sent == 0)
      return Error{ErrorCode::kNotFound, "holds no message in that span on those channels", logs.front()};
  } while (settings.loop);
  return figures;
}

}  // namespace rfmvo::play
