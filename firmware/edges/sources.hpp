// Event sources around another source: each changes one thing on the way.
#pragma once

#include <functional>
#include <optional>

#include "edges/event_io.hpp"

namespace rfmvo {

// Replaces what a Start event carries; its time stays.
class ReconfiguredSource : public EventSource {
 public:
  // Without a calibration, the recorded one stays.
  ReconfiguredSource(EventSource& inner, Config config, std::optional<Calibration> calibration);
  [[nodiscard]] Result<std::optional<Event>> next() override;

 private:
  EventSource& inner_;
  Config config_;
  std::optional<Calibration> calibration_;
};

// Hands out each event when its time has come: `speed` times as fast as it happened. A signal ends
// the wait at once.
class PacedSource : public EventSource {
 public:
  PacedSource(EventSource& inner, double speed);
  [[nodiscard]] Result<std::optional<Event>> next() override;

 private:
  EventSource& inner_;
  double speed_;
  std::optional<DeviceTime> first_event_;
  std::int64_t first_clock_ns_ = 0;
};

// Ends the stream, as if it were over, once stop() says so.
class StoppableSource : public EventSource {
 public:
  StoppableSource(EventSource& inner, std::function<bool()> stop);
  [[nodiscard]] Result<std::optional<Event>> next() override;

 private:
  EventSource& inner_;
  std::function<bool()> stop_;
};

}  // namespace rfmvo
