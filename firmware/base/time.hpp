// Time as integer nanoseconds of a NAMED clock. Two clocks never mix: only the reader-clock
// filter at the edge may turn a ReaderTime into a DeviceTime.
#pragma once

#include <compare>
#include <cstdint>

namespace rfmvo {

struct Duration {
  std::int64_t ns = 0;

  [[nodiscard]] constexpr double seconds() const { return static_cast<double>(ns) * 1e-9; }
  [[nodiscard]] static constexpr Duration from_seconds(double s) {
    return {static_cast<std::int64_t>(s * 1e9 + (s < 0 ? -0.5 : 0.5))};
  }
  constexpr auto operator<=>(const Duration&) const = default;
};

template <class Clock>
struct TimePoint {
  std::int64_t ns = 0;  // since the clock's own epoch

  [[nodiscard]] constexpr std::int64_t us() const { return ns / 1000; }
  [[nodiscard]] static constexpr TimePoint from_us(std::int64_t us) { return {us * 1000}; }
  constexpr auto operator<=>(const TimePoint&) const = default;
  friend constexpr Duration operator-(TimePoint a, TimePoint b) { return {a.ns - b.ns}; }
  friend constexpr TimePoint operator+(TimePoint a, Duration d) { return {a.ns + d.ns}; }
  friend constexpr TimePoint operator-(TimePoint a, Duration d) { return {a.ns - d.ns}; }
};

struct DeviceClock;  // the board's clock: camera stamps, journal, everything published
struct ReaderClock;  // the RFID reader's own clock; may believe it is the year 2000

using DeviceTime = TimePoint<DeviceClock>;
using ReaderTime = TimePoint<ReaderClock>;

}  // namespace rfmvo
