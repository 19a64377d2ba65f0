// Delays of one period, for their percentiles.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/time.hpp"

namespace rfmvo {

class LatencyWindow {
 public:
  void add(Duration delay) {
    if (delays_.size() < kMost) delays_.push_back(delay);
  }
  // The smallest delay that `share` of all do not exceed; 0 if there was none.
  [[nodiscard]] Duration percentile(double share) {
    if (delays_.empty()) return {};
    const auto count = static_cast<double>(delays_.size());
    const auto rank = static_cast<std::size_t>(std::clamp(std::ceil(share * count), 1.0, count)) - 1;
    std::nth_element(delays_.begin(), delays_.begin() + static_cast<std::ptrdiff_t>(rank), delays_.end());
    return delays_[rank];
  }
  void clear() { delays_.clear(); }

 private:
  static constexpr std::size_t kMost = 100'000;  // a period is a second
  std::vector<Duration> delays_;
};

}  // namespace rfmvo
