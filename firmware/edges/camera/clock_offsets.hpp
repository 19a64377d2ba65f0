// How the device's clock stands to the kernel's, read at this moment.
#pragma once

#include "edges/camera/sensor_time.hpp"
#include "edges/device_clock.hpp"

namespace rfmvo {

// Each clock is read between two readings of the device's; of several such triples the narrowest counts, so that a
// pause of the thread in between does no harm.
[[nodiscard]] ClockOffsets read_clock_offsets(const DeviceClockFunction& clock);

}  // namespace rfmvo
