#include "edges/device_clock.hpp"

#include <ctime>

namespace rfmvo {
namespace {

std::int64_t read_ns(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

}  // namespace

DeviceClockFunction device_clock() {
  const std::int64_t difference_ns = read_ns(CLOCK_REALTIME) - read_ns(CLOCK_MONOTONIC);
  return [difference_ns] { return DeviceTime{read_ns(CLOCK_MONOTONIC) + difference_ns}; };
}

}  // namespace rfmvo
