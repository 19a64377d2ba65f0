#include "inspect/sequence.hpp"

#include "inspect/message_types.hpp"
#include "rfmvo/frame_t.hpp"

namespace rfmvo::inspect {

std::optional<std::int64_t> sequence_of(std::span<const std::uint8_t> message) {
  constexpr std::size_t kSequenceOffset = 16;  // after fingerprint and utime
  if (message.size() < kSequenceOffset + 8 || fingerprint_of(message) != frame_t::getHash()) return std::nullopt;
  return big_endian_int64(message, kSequenceOffset);
}

void SequenceLoss::add(std::string_view channel, std::int64_t sequence) {
  const auto known = counters_.find(channel);
  if (known == counters_.end()) {
    counters_.emplace(std::string(channel), Counter{sequence, 0});
    return;
  }
  Counter& counter = known->second;
  if (sequence > counter.last + 1) counter.lost += sequence - counter.last - 1;
  counter.last = sequence;
}

std::optional<std::int64_t> SequenceLoss::lost(const std::string& channel) const {
  const auto known = counters_.find(channel);
  if (known == counters_.end()) return std::nullopt;
  return known->second.lost;
}

}  // namespace rfmvo::inspect
