#include "edges/box/service_notify.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string_view>

#include "edges/net/fd.hpp"

namespace rfmvo {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

std::optional<std::int64_t> number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// WATCHDOG_PID says whom it is for, if it is there.
std::optional<Duration> watchdog_of_environment() {
  const auto us = number(environment("WATCHDOG_USEC"));
  const std::string_view pid = environment("WATCHDOG_PID");
  if (!us || *us <= 0 || (!pid.empty() && number(pid) != ::getpid())) return std::nullopt;
  return Duration{*us * 1000};
}

}  // namespace

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return text;
}

ServiceNotify::ServiceNotify() : ServiceNotify(std::string(environment("NOTIFY_SOCKET")), watchdog_of_environment()) {}

ServiceNotify::ServiceNotify(std::string socket, std::optional<Duration> watchdog)
    : socket_(std::move(socket)), watchdog_(watchdog) {}

void ServiceNotify::send(const std::string& text) const {
  sockaddr_un address{};
  if (socket_.empty() || socket_.size() >= sizeof(address.sun_path)) return;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, socket_.data(), socket_.size());
  if (socket_.front() == '@') address.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
  const net::Fd fd(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!fd.valid()) return;
  // Systemd must never hold up the box.
  (void)::sendto(fd.get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                 reinterpret_cast<const sockaddr*>(&address), size);
}

void ServiceNotify::ready(const std::string& status) const { send("READY=1\nSTATUS=" + one_line(status)); }

void ServiceNotify::reloading() const {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t us = now.tv_sec * std::int64_t{1'000'000} + now.tv_nsec / 1000;
  send("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(us));
}

void ServiceNotify::stopping() const { send("STOPPING=1"); }
void ServiceNotify::status(const std::string& text) const { send("STATUS=" + one_line(text)); }
void ServiceNotify::alive() const { send("WATCHDOG=1"); }

}  // namespace rfmvo
