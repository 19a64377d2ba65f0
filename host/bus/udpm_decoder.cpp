#include "bus/udpm_decoder.hpp"

#include <algorithm>

namespace rfmvo {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t kSmall = 0x4C433032, kFragment = 0x4C433033;  // "LC02", "LC03"
constexpr std::size_t kSmallHeader = 8, kFragmentHeader = 20;
constexpr std::size_t kMaxChannel = 63;                    // LCM_MAX_CHANNEL_NAME_LENGTH
constexpr std::size_t kMaxMessage = std::size_t{1} << 28;  // 256 MB, as log files
constexpr std::size_t kMaxSenders = 256;
// Numbers this far below the expected one are those of a new process, not of a datagram that was overtaken.
constexpr std::uint32_t kOvertaken = 256;

std::uint32_t uint_at(Bytes bytes, std::size_t offset, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[offset + i];
  return value;
}

// The channel at the start of `bytes`, which lose it and its NUL. Nothing: there is none.
std::optional<std::string> take_channel(Bytes& bytes) {
  const auto end = std::find(bytes.begin(), bytes.end(), 0);
  const auto length = static_cast<std::size_t>(end - bytes.begin());
  if (end == bytes.end() || length == 0 || length > kMaxChannel) return std::nullopt;
  std::string channel(reinterpret_cast<const char*>(bytes.data()), length);
  bytes = bytes.subspan(length + 1);
  return channel;
}

}  // namespace

std::optional<BusMessage> UdpmDecoder::on(std::uint64_t sender, Bytes datagram) {
  if (datagram.size() < kSmallHeader) return std::nullopt;
  const std::uint32_t magic = uint_at(datagram, 0, 4);
  if (magic == kSmall) return on_small(sender, datagram);
  if (magic == kFragment && datagram.size() >= kFragmentHeader) return on_fragment(sender, datagram);
  return std::nullopt;
}

UdpmDecoder::Sender& UdpmDecoder::sender_of(std::uint64_t sender, std::uint32_t sequence) {
  const auto known = senders_.find(sender);
  if (known != senders_.end()) return known->second;
  if (senders_.size() >= kMaxSenders) senders_.erase(senders_.begin());
  return senders_.emplace(sender, Sender{sequence, std::nullopt}).first->second;
}

// The whole message of this number is here.
void UdpmDecoder::arrived(Sender& sender, std::uint32_t sequence) {
  const std::uint32_t ahead = sequence - sender.next, behind = sender.next - sequence;  // modulo 2^32
  if (ahead < UINT32_MAX / 2) {
    lost_ += ahead;
    sender.next = sequence + 1;
  } else if (behind <= kOvertaken && sequence != 0) {
    lost_ -= std::min<std::uint64_t>(lost_, 1);  // it was taken for lost
  } else {
    sender.next = sequence + 1;
  }
}

// A message of which not all fragments came: its number was never counted as arrived, so the next one counts it.
void UdpmDecoder::give_up(Sender& sender) { sender.assembly.reset(); }

// What is waiting for fragments stays below the size of one largest message.
void UdpmDecoder::make_room(std::size_t bytes) {
  for (const auto& [id, sender] : senders_) bytes += sender.assembly ? sender.assembly->message.data.size() : 0;
  if (bytes <= kMaxMessage) return;
  for (auto& [id, sender] : senders_) give_up(sender);
}

std::optional<BusMessage> UdpmDecoder::on_small(std::uint64_t id, Bytes datagram) {
  const std::uint32_t sequence = uint_at(datagram, 4, 4);
  Bytes rest = datagram.subspan(kSmallHeader);
  auto channel = take_channel(rest);
  if (!channel) return std::nullopt;
  arrived(sender_of(id, sequence), sequence);
  return BusMessage{std::move(*channel), {rest.begin(), rest.end()}};
}

std::optional<BusMessage> UdpmDecoder::on_fragment(std::uint64_t id, Bytes datagram) {
  const std::uint32_t sequence = uint_at(datagram, 4, 4);
  const std::size_t size = uint_at(datagram, 8, 4), offset = uint_at(datagram, 12, 4);
  const std::size_t number = uint_at(datagram, 16, 2), count = uint_at(datagram, 18, 2);
  Bytes rest = datagram.subspan(kFragmentHeader);
  std::optional<std::string> channel;
  if (number == 0 && !(channel = take_channel(rest))) return std::nullopt;
  if (size > kMaxMessage || number >= count || offset > size || rest.size() > size - offset) return std::nullopt;

  Sender& sender = sender_of(id, sequence);
  auto& assembly = sender.assembly;
  if (assembly && assembly->sequence != sequence) give_up(sender);
  if (!assembly) make_room(size);
  if (!assembly) assembly = Assembly{sequence, 0, std::vector<bool>(count), 0, {"", std::vector<std::uint8_t>(size)}};
  if (assembly->message.data.size() != size || assembly->have.size() != count || assembly->have[number])
    return std::nullopt;
  assembly->have[number] = true;
  if (channel) assembly->message.channel = std::move(*channel);
  std::copy(rest.begin(), rest.end(), assembly->message.data.begin() + static_cast<std::ptrdiff_t>(offset));
  assembly->bytes += rest.size();
  if (++assembly->fragments < count || assembly->bytes != size) return std::nullopt;
  arrived(sender, sequence);
  BusMessage message = std::move(assembly->message);
  assembly.reset();
  return message;
}

}  // namespace rfmvo
