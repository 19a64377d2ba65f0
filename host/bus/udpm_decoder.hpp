// Datagrams of LCM's UDP multicast protocol to messages. Pure: bytes in, messages and counts out. Format (LCM, "UDP
// Multicast Protocol Description", big-endian): small message: "LC02", sequence u32, channel with its NUL, data;
// fragment: "LC03", sequence u32, size of the data u32, offset u32, number u16, count u16, then in number 0 the
// channel with its NUL, then a piece of the data.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include "bus/bus_listener.hpp"

namespace rfmvo {

class UdpmDecoder {
 public:
  // A message that `datagram` completes. `sender`: one value per address and port. What is not LCM is ignored.
  std::optional<BusMessage> on(std::uint64_t sender, std::span<const std::uint8_t> datagram);
  // Sequence numbers of which no whole message came, between the first and the last of each sender.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  struct Assembly {
    std::uint32_t sequence = 0;
    std::size_t bytes = 0;  // so far
    std::vector<bool> have;
    std::size_t fragments = 0;
    BusMessage message;
  };
  struct Sender {
    std::uint32_t next = 0;  // sequence
    std::optional<Assembly> assembly;
  };

  std::optional<BusMessage> on_small(std::uint64_t sender, std::span<const std::uint8_t> datagram);
  std::optional<BusMessage> on_fragment(std::uint64_t sender, std::span<const std::uint8_t> datagram);
  Sender& sender_of(std::uint64_t sender, std::uint32_t sequence);
  void arrived(Sender& sender, std::uint32_t sequence);
  static void give_up(Sender& sender);
  void make_room(std::size_t bytes);

  std::map<std::uint64_t, Sender> senders_;
  std::uint64_t lost_ = 0;
};

}  // namespace rfmvo
