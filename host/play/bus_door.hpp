// The player's door to the real world: the monotonic clock, the keyboard, an LCM bus.
#pragma once

#include <termios.h>

#include <memory>
#include <optional>

#include "commands/progress_line.hpp"
#include "play/player.hpp"

namespace lcm {
class LCM;
}

namespace rfmvo::play {

class BusDoor : public PlayDoor {
 public:
  // Keys are read if stdin is a terminal; a stop signal counts as kQuit. Errors: as LcmBus::create.
  [[nodiscard]] static Result<std::unique_ptr<BusDoor>> create(const std::string& url);
  ~BusDoor() override;
  BusDoor(const BusDoor&) = delete;
  BusDoor& operator=(const BusDoor&) = delete;

  [[nodiscard]] std::int64_t now_ns() override;
  [[nodiscard]] Key wait_until(std::int64_t ns) override;
  [[nodiscard]] Status send(const LogRecord& record, Duration position) override;
  [[nodiscard]] bool has_keys() const { return before_.has_value(); }

 private:
  explicit BusDoor(std::unique_ptr<lcm::LCM> bus);

  std::unique_ptr<lcm::LCM> bus_;
  std::optional<termios> before_;  // of the terminal, if it is one
  ProgressLine line_{""};
  std::int64_t shown_ns_ = 0;
};

}  // namespace rfmvo::play
