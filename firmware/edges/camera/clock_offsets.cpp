#include "edges/camera/clock_offsets.hpp"

#include <ctime>
#include <limits>

namespace rfmvo {
namespace {

constexpr int kTries = 8;

std::int64_t offset_ns(const DeviceClockFunction& device, clockid_t other) {
  std::int64_t narrowest_ns = std::numeric_limits<std::int64_t>::max(), offset = 0;
  for (int k = 0; k < kTries; ++k) {
    timespec now{};
    const DeviceTime before = device();
    (void)::clock_gettime(other, &now);
    const DeviceTime after = device();
    const std::int64_t width_ns = (after - before).ns;
    if (width_ns >= narrowest_ns) continue;
    narrowest_ns = width_ns;
    offset = before.ns + width_ns / 2 - (now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec);
  }
  return offset;
}

}  // namespace

ClockOffsets read_clock_offsets(const DeviceClockFunction& clock) {
  return {offset_ns(clock, CLOCK_MONOTONIC), offset_ns(clock, CLOCK_BOOTTIME)};
}

}  // namespace rfmvo
