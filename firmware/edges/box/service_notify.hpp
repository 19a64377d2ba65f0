// What systemd is told (sd_notify(3), a datagram to $NOTIFY_SOCKET): ready, alive, what is going on. Without systemd,
// nothing happens.
#pragma once

#include <optional>
#include <string>

#include "base/time.hpp"

namespace rfmvo {

class ServiceNotify {
 public:
  // As the environment says: NOTIFY_SOCKET, WATCHDOG_USEC, WATCHDOG_PID.
  ServiceNotify();
  ServiceNotify(std::string socket, std::optional<Duration> watchdog);

  void ready(const std::string& status) const;
  void reloading() const;
  void stopping() const;
  void status(const std::string& text) const;
  void alive() const;
  // Within so long systemd expects alive(); nothing if it does not watch.
  [[nodiscard]] std::optional<Duration> watchdog() const { return watchdog_; }

 private:
  void send(const std::string& text) const;

  std::string socket_;  // "@..." is an abstract one
  std::optional<Duration> watchdog_;
};

// One line, whatever `text` holds.
[[nodiscard]] std::string one_line(std::string text);

}  // namespace rfmvo
