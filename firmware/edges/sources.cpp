#include "edges/sources.hpp"

#include <ctime>

namespace rfmvo {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNsPerSecond + now.tv_nsec;
}

}  // namespace

ReconfiguredSource::ReconfiguredSource(EventSource& inner, Config config, std::optional<Calibration> calibration)
    : inner_(inner), config_(std::move(config)), calibration_(std::move(calibration)) {}

Result<std::optional<Event>> ReconfiguredSource::next() {
  auto result = inner_.next();
  if (!result || !result.value()) return result;
  std::optional<Event> event = std::move(result).value();
  if (auto* start = std::get_if<Start>(&*event)) {
    start->config = config_;
    if (calibration_) start->calibration = *calibration_;
  }
  return event;
}

PacedSource::PacedSource(EventSource& inner, double speed) : inner_(inner), speed_(speed) { RFMVO_ASSERT(speed > 0.0); }

Result<std::optional<Event>> PacedSource::next() {
  auto result = inner_.next();
  if (!result || !result.value()) return result;
  const DeviceTime time = time_of(*result.value());
  if (!first_event_) {
    first_event_ = time;
    first_clock_ns_ = monotonic_ns();
  }
  const double wait_ns = static_cast<double>((time - *first_event_).ns) / speed_;
  const std::int64_t due_ns = first_clock_ns_ + static_cast<std::int64_t>(wait_ns);
  if (due_ns > monotonic_ns()) {
    const timespec due{due_ns / kNsPerSecond, due_ns % kNsPerSecond};
    (void)::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);  // EINTR: do not wait further
  }
  return result;
}

StoppableSource::StoppableSource(EventSource& inner, std::function<bool()> stop)
    : inner_(inner), stop_(std::move(stop)) {}

Result<std::optional<Event>> StoppableSource::next() {
  if (stop_()) return std::optional<Event>();
  auto result = inner_.next();
  // Asked again: the inner source may have waited until a signal came.
  if (stop_()) return std::optional<Event>();
  return result;
}

}  // namespace rfmvo
