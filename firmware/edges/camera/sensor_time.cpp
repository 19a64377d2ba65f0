#include "edges/camera/sensor_time.hpp"

#include <cmath>

namespace rfmvo {

std::optional<DeviceTime> device_time(const SensorStamp& stamp, const ClockOffsets& offsets, DeviceTime arrival) {
  if (stamp.clock == SensorClock::kUnknown) return std::nullopt;
  const std::int64_t offset_ns =
      stamp.clock == SensorClock::kMonotonic ? offsets.device_less_monotonic_ns : offsets.device_less_boottime_ns;
  // A driver may hand out anything: the sum must not overflow before it is compared.
  std::int64_t ns = 0, age_ns = 0;
  if (__builtin_add_overflow(stamp.ns, offset_ns, &ns) || __builtin_sub_overflow(arrival.ns, ns, &age_ns))
    return std::nullopt;
  if (age_ns > kStampPlausible.ns || age_ns < -kStampPlausible.ns) return std::nullopt;
  return DeviceTime{ns};
}

Duration to_mid_exposure(StampInstant instant, const ShutterTiming& shutter) {
  const std::int64_t half_exposure_ns = shutter.exposure.ns / 2;
  const auto row_ns = std::llround(static_cast<double>(shutter.readout.ns) * shutter.row_share);
  switch (instant) {
    case StampInstant::kExposureStart: return {half_exposure_ns + row_ns};
    case StampInstant::kReadoutStart: return {row_ns - half_exposure_ns};
    case StampInstant::kReadoutEnd: return {row_ns - shutter.readout.ns - half_exposure_ns};
  }
  return {};
}

}  // namespace rfmvo
