// The bytes of an MCAP record: one of opcode, u64 length, content; all numbers little-endian; texts and lists with
// their u32 length in front.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rfmvo::mcap {

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

class Content {
 public:
  Content& u8(std::uint8_t x) { return number<1>(x); }
  Content& u16(std::uint16_t x) { return number<2>(x); }
  Content& u32(std::uint32_t x) { return number<4>(x); }
  Content& u64(std::uint64_t x) { return number<8>(x); }
  Content& text(std::string_view x) { return u32(static_cast<std::uint32_t>(x.size())).raw(x); }
  Content& list(const Content& entries) { return text(entries.bytes_); }
  Content& raw(std::string_view x) {
    bytes_ += x;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  template <int Bytes>
  Content& number(std::uint64_t x) {
    for (int i = 0; i < Bytes; ++i) bytes_ += static_cast<char>(x >> (8 * i) & 0xFF);
    return *this;
  }
  std::string bytes_;
};

[[nodiscard]] inline std::string record(Opcode opcode, const Content& content) {
  Content whole;
  whole.u8(static_cast<std::uint8_t>(opcode)).u64(content.bytes().size());
  return whole.bytes() + content.bytes();
}

}  // namespace rfmvo::mcap
