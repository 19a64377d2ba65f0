// Counts the pictures that never came, by the driver's sequence numbers.
#pragma once

#include <cstdint>
#include <optional>

namespace rfmvo {

class FrameGaps {
 public:
  struct Counted {
    std::int64_t sequence = 0;  // never wraps, never begins again
    std::uint64_t lost = 0;     // pictures between the last one and this one
  };

  Counted on(std::uint32_t sequence) {
    std::uint32_t step = 1;
    if (last_) step = sequence - *last_;  // modulo 2^32: the driver's counter wraps
    // Not forward: the driver began to count anew, and what was lost meanwhile nobody knows.
    if (step == 0 || step >= kBackward) step = 1;
    last_ = sequence;
    sequence_ += step;
    lost_ += step - 1;
    return {sequence_, step - 1};
  }
  // The camera was started anew: its counter tells nothing about the pause.
  void on_restart() { last_.reset(); }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  static constexpr std::uint32_t kBackward = std::uint32_t{1} << 31;
  std::optional<std::uint32_t> last_;
  std::int64_t sequence_ = -1;
  std::uint64_t lost_ = 0;
};

}  // namespace rfmvo
