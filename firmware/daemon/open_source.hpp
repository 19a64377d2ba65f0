// The stream of events that the configuration names.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "edges/camera/camera_source.hpp"
#include "edges/live_source.hpp"

namespace rfmvo {

struct OpenedSource {
  std::unique_ptr<EventSource> events;  // the first one is a Start
  DeviceTime start;
  DeviceClockFunction clock;
  // Of a live one; null: recorded events, as fast as they can be used.
  LiveSource* live = nullptr;
  CameraSource* camera = nullptr;  // hardware
  std::shared_ptr<CameraCounters> camera_counters = std::make_shared<CameraCounters>();
};

// `should_stop`: ends a live stream after what has arrived until then.
[[nodiscard]] Result<OpenedSource> open_source(const Config& config, const std::optional<Calibration>& calibration,
                                               std::function<bool()> should_stop);

}  // namespace rfmvo
