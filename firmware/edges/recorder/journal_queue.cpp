#include "edges/recorder/journal_queue.hpp"

#include <algorithm>
#include <utility>

namespace rfmvo {
namespace {

constexpr std::int64_t kEventBytes = 512;  // of anything but a picture, roughly and rather more

std::int64_t bytes_of(const Event& event) {
  const auto* frame = std::get_if<Frame>(&event);
  if (frame == nullptr) return kEventBytes;
  const auto size = [](const auto& bytes) { return bytes ? static_cast<std::int64_t>(bytes->size()) : 0; };
  return kEventBytes + size(frame->grey) + size(frame->encoded);
}

bool is_frame(const JournalItem& item) { return std::holds_alternative<Frame>(item.event); }

}  // namespace

bool JournalQueue::has_room(const Event& event) const {
  return items_.empty() || bytes_ + bytes_of(event) <= max_bytes_;
}

bool JournalQueue::drop_oldest_frame() {
  const auto oldest = std::find_if(items_.begin(), items_.end(), is_frame);
  if (oldest == items_.end()) return false;
  JournalLoss loss = oldest->lost_before;
  ++loss.frames;
  ++lost_.frames;
  bytes_ -= oldest->bytes;
  const auto behind = items_.erase(oldest);
  (behind == items_.end() ? tail_loss_ : behind->lost_before) += loss;
  return true;
}

void JournalQueue::push(Event event) {
  while (!has_room(event) && drop_oldest_frame()) {
  }
  if (!has_room(event)) {
    const bool frame = std::holds_alternative<Frame>(event);
    const JournalLoss loss{frame ? 1u : 0u, frame ? 0u : 1u};
    lost_ += loss;
    tail_loss_ += loss;
    return;
  }
  JournalItem item{std::move(event), take_tail_loss(), 0};
  item.bytes = bytes_of(item.event);
  bytes_ += item.bytes;
  items_.push_back(std::move(item));
}

std::optional<JournalItem> JournalQueue::pop() {
  if (items_.empty()) return std::nullopt;
  JournalItem item = std::move(items_.front());
  items_.pop_front();
  bytes_ -= item.bytes;
  return item;
}

JournalLoss JournalQueue::take_tail_loss() { return std::exchange(tail_loss_, {}); }

}  // namespace rfmvo
