// Channels in Hz, from the reader's own table: no region is written down here.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/result.hpp"
#include "edges/llrp/messages.hpp"

namespace rfmvo::llrp {

struct ChannelTable {
  bool hopping = false;
  std::uint8_t hop_table_id = 0;           // 0: fixed frequencies
  std::vector<std::uint32_t> channels_hz;  // ChannelIndex 1 is the first, LLRP 1.0.1 section 10.2.4

  [[nodiscard]] std::optional<std::uint32_t> frequency_hz(std::uint16_t channel_index) const {
    if (channel_index == 0 || channel_index > channels_hz.size()) return std::nullopt;
    return channels_hz[channel_index - 1U];
  }
};

// The table with this id, 0: the first; fixed frequencies if the reader does not hop. Errors: no table, no such
// table, a channel outside 840..960 MHz (a reader was seen to report 2293250 kHz).
[[nodiscard]] Result<ChannelTable> channel_table(const GetReaderCapabilitiesResponse& capabilities,
                                                 std::uint8_t hop_table_id);

}  // namespace rfmvo::llrp
