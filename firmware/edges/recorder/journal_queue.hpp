// What waits to be written to the journal. Bounded: when the card is slow, the oldest frames go first, and where each
// loss was is remembered. One thread at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "estimator/event.hpp"

namespace rfmvo {

struct JournalLoss {
  std::uint64_t frames = 0, others = 0;
  [[nodiscard]] bool any() const { return frames + others > 0; }
  JournalLoss& operator+=(const JournalLoss& more) {
    frames += more.frames;
    others += more.others;
    return *this;
  }
};

struct JournalItem {
  Event event;
  JournalLoss lost_before;  // between the item before and this one
  std::int64_t bytes = 0;   // about
};

class JournalQueue {
 public:
  explicit JournalQueue(std::int64_t max_bytes) : max_bytes_(max_bytes) {}

  [[nodiscard]] bool has_room(const Event& event) const;
  // Frames make room, the oldest first; only when there is none left, what is not a frame is not taken.
  void push(Event event);
  [[nodiscard]] std::optional<JournalItem> pop();
  // What was lost behind the last item: belongs in front of what comes next.
  [[nodiscard]] JournalLoss take_tail_loss();

  [[nodiscard]] std::int64_t bytes() const { return bytes_; }
  [[nodiscard]] bool empty() const { return items_.empty(); }
  [[nodiscard]] const JournalLoss& lost() const { return lost_; }

 private:
  [[nodiscard]] bool drop_oldest_frame();

  std::int64_t max_bytes_;
  std::deque<JournalItem> items_;
  std::int64_t bytes_ = 0;
  JournalLoss lost_, tail_loss_;
};

}  // namespace rfmvo
