// The clock of this box: nanoseconds since 1970 as they were when it was made, and from there on without steps.
#pragma once

#include <functional>

#include "base/time.hpp"

namespace rfmvo {

using DeviceClockFunction = std::function<DeviceTime()>;

// CLOCK_REALTIME once, then CLOCK_MONOTONIC: whoever sets the box's clock does not move events.
[[nodiscard]] DeviceClockFunction device_clock();

}  // namespace rfmvo
