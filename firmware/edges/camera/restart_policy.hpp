// When a silent camera counts as stalled, and when to try again. Simulated time in, decisions out.
#pragma once

#include <algorithm>

#include "base/time.hpp"

namespace rfmvo {

class RestartPolicy {
 public:
  RestartPolicy(Duration stall, DeviceTime now) : stall_(stall), alive_(now), next_try_(now) {}

  void on_started(DeviceTime now) { alive_ = now; }
  void on_picture(DeviceTime now) {
    alive_ = now;
    pause_ = kFirstPause;
  }
  // Starting failed, or the camera stalled: twice as long a pause each time, until a picture has come.
  void on_failure(DeviceTime now) {
    next_try_ = now + pause_;
    pause_ = std::min(Duration{pause_.ns * 2}, kLongestPause);
  }
  [[nodiscard]] bool is_stalled(DeviceTime now) const { return now - alive_ > stall_; }
  [[nodiscard]] bool may_try(DeviceTime now) const { return now >= next_try_; }

 private:
  static constexpr Duration kFirstPause{100'000'000}, kLongestPause{2'000'000'000};
  Duration stall_;
  DeviceTime alive_, next_try_;
  Duration pause_ = kFirstPause;
};

}  // namespace rfmvo
