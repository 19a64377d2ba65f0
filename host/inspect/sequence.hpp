// Messages that count themselves: what is missing between two of them was lost.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rfmvo::inspect {

// The sender's own counter in a message; nothing where its type has none. Today: frame_t.
[[nodiscard]] std::optional<std::int64_t> sequence_of(std::span<const std::uint8_t> message);

// How many numbers were left out, by channel. A counter that goes back was begun anew: no loss.
class SequenceLoss {
 public:
  void add(std::string_view channel, std::int64_t sequence);
  // Nothing if no message of the channel counted itself.
  [[nodiscard]] std::optional<std::int64_t> lost(const std::string& channel) const;

 private:
  struct Counter {
    std::int64_t last = 0, lost = 0;
  };
  std::map<std::string, Counter, std::less<>> counters_;
};

}  // namespace rfmvo::inspect
