#include "play/bus_door.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <lcm/lcm-cpp.hpp>

#include "edges/lcm_bus.hpp"
#include "edges/stop_signal.hpp"

namespace rfmvo::play {
namespace {

constexpr std::int64_t kShowEvery_ns = 100'000'000;

Key key_of(char c) {
  switch (c) {
    case ' ':
      return Key::kPause;
    case '.':
    case 's':
      return Key::kStep;
    case 'q':
      return Key::kQuit;
    default:
      return Key::kNone;
  }
}

}  // namespace

BusDoor::BusDoor(std::unique_ptr<lcm::LCM> bus) : bus_(std::move(bus)) {
  termios now{};
  if (::isatty(STDIN_FILENO) != 1 || ::tcgetattr(STDIN_FILENO, &now) != 0) return;
  before_ = now;
  now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // each key at once, and not shown
  (void)::tcsetattr(STDIN_FILENO, TCSANOW, &now);
}

BusDoor::~BusDoor() {
  if (before_) (void)::tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

Result<std::unique_ptr<BusDoor>> BusDoor::create(const std::string& url) {
  // It says in one line what is wrong with a url; liblcm does not.
  const auto checked = LcmBus::create(url, "");
  if (!checked) return checked.error();
  auto bus = std::make_unique<lcm::LCM>(url);
  if (!bus->good()) return Error{ErrorCode::kUnsupported, "LCM cannot open this url", url};
  return std::unique_ptr<BusDoor>(new BusDoor(std::move(bus)));
}

std::int64_t BusDoor::now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

Key BusDoor::wait_until(std::int64_t ns) {
  constexpr std::int64_t kLongest_ns = 1'000'000'000;  // then it looks again, whatever happens
  while (true) {
    if (stop_requested()) return Key::kQuit;
    const std::int64_t left_ns =
        std::clamp<std::int64_t>(ns == kForever_ns ? kLongest_ns : ns - now_ns(), 0, kLongest_ns);
    pollfd keyboard{before_ ? STDIN_FILENO : -1, POLLIN, 0};  // -1: ignored
    const timespec wait{left_ns / 1'000'000'000, left_ns % 1'000'000'000};
    const int ready = ::ppoll(&keyboard, 1, &wait, nullptr);
    if (ready > 0) {
      char c = 0;
      if (::read(STDIN_FILENO, &c, 1) != 1) return Key::kQuit;  // the terminal is gone
      if (const Key key = key_of(c); key != Key::kNone) return key;
    }
    if (!stop_requested() && ns != kForever_ns && now_ns() >= ns) return Key::kNone;
  }
}

Status BusDoor::send(const LogRecord& record, Duration position) {
  if (bus_->publish(record.channel, record.data.data(), static_cast<unsigned>(record.data.size())) != 0)
    return Error{ErrorCode::kUnwritable, std::string("cannot publish: ") + std::strerror(errno), record.channel};
  if (now_ns() - shown_ns_ >= kShowEvery_ns) {
    shown_ns_ = now_ns();
    line_.say(fmt::format("{:9.2f} s  {}", position.seconds(), record.channel));
  }
  return Done{};
}

}  // namespace rfmvo::play
