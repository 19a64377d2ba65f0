// A folder of images as if a camera took them now: each one comes at its time on the device's clock, and carries it.
#pragma once

#include <atomic>
#include <optional>

#include "edges/device_clock.hpp"
#include "edges/image_folder.hpp"

namespace rfmvo {

class LiveImages : public EventSource {
 public:
  // The first image is of the time `first`. next() waits; once `stop` is set it ends the stream within 50 ms.
  LiveImages(std::unique_ptr<ImageFolder> folder, DeviceTime first, DeviceClockFunction clock,
             const std::atomic<bool>& stop);
  [[nodiscard]] Result<std::optional<Event>> next() override;

 private:
  std::unique_ptr<ImageFolder> folder_;
  DeviceTime first_;
  DeviceClockFunction clock_;
  const std::atomic<bool>& stop_;
  std::optional<DeviceTime> recorded_first_;
};

}  // namespace rfmvo
