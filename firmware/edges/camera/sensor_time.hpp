// When a picture was taken, from what the driver says: which clock it read, and at which moment. Pure arithmetic; who
// reads the clocks is clock_offsets.hpp.
#pragma once

#include <cstdint>
#include <optional>

#include "base/time.hpp"

namespace rfmvo {

enum class SensorClock {
  kMonotonic,  // CLOCK_MONOTONIC: V4L2 with V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC; the Pi's CSI receivers
  kBoottime,   // CLOCK_BOOTTIME: what libcamera documents; the same as MONOTONIC but for time spent suspended
  kUnknown,    // the driver does not say: the time of arrival is all there is
};

// What happened when the driver read its clock.
enum class StampInstant {
  kExposureStart,  // of the first row (V4L2: SOE)
  kReadoutStart,   // the first row leaves the sensor: its exposure is over (CSI frame start)
  kReadoutEnd,     // the last row has arrived (V4L2: EOF)
};

struct SensorStamp {
  SensorClock clock = SensorClock::kUnknown;
  StampInstant instant = StampInstant::kReadoutEnd;
  std::int64_t ns = 0;
};

// Device clock less each of the kernel's clocks at one moment.
struct ClockOffsets {
  std::int64_t device_less_monotonic_ns = 0;
  std::int64_t device_less_boottime_ns = 0;
};

// How the sensor exposes the picture that is used.
struct ShutterTiming {
  Duration exposure;      // of each row
  Duration readout;       // from the first row of the sensor's whole picture to its last; 0: global shutter
  double row_share = 0.5; // of the used picture's middle row: 0 first, 1 last row of the whole picture
};

// A stamp that is further from its arrival than this is of another clock than it claims.
inline constexpr Duration kStampPlausible{2'000'000'000};

// The stamp on the device's clock; nothing if the clock is unknown, or the stamp is not near `arrival`.
[[nodiscard]] std::optional<DeviceTime> device_time(const SensorStamp& stamp, const ClockOffsets& offsets,
                                                    DeviceTime arrival);

// From the stamp to the middle of the exposure of the used picture's middle row.
[[nodiscard]] Duration to_mid_exposure(StampInstant instant, const ShutterTiming& shutter);

}  // namespace rfmvo
