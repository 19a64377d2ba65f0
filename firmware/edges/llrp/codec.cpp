#include "edges/llrp/codec.hpp"

#include "edges/llrp/decoder.hpp"
#include "edges/llrp/encoder.hpp"
#include "edges/llrp/parameters.hpp"

namespace rfmvo::llrp {
namespace {

constexpr std::uint16_t kTypeMask = 0x3FF;
constexpr int kVersionShift = 10, kVersionMask = 7;

// Of LLRP 1.0.1 and 1.1, those that no type here stands for: tag access, version negotiation.
constexpr std::uint16_t kOtherMessages[] = {40, 42, 43, 44, 45, 46, 47, 50, 52, 53, 54, 55, 56, 57};

template <class T>
bool decode_as(std::uint16_t type, std::span<const std::uint8_t> body, Decoding& decoding, Body& out) {
  if constexpr (!std::is_same_v<T, RawMessage>) {
    if (T::kName.type != type) return false;
    decoding.path.push_back(T::kName.text);
    decode_into(out.emplace<T>(), body, decoding);
    return true;
  }
  return false;
}

template <class... T>
bool decode_any(std::uint16_t type, std::span<const std::uint8_t> body, Decoding& decoding, std::variant<T...>& out) {
  return (decode_as<T>(type, body, decoding, out) || ...);
}

}  // namespace

Result<Header> decode_header(std::span<const std::uint8_t> bytes) {
  RFMVO_ASSERT(bytes.size() >= kHeaderBytes);
  const auto u32 = [&](std::size_t at) {
    return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 | std::uint32_t{bytes[at + 2]} << 8 |
           bytes[at + 3];
  };
  const unsigned first = bytes[0] * 256U + bytes[1];
  Header header;
  header.version = static_cast<std::uint8_t>(first >> kVersionShift & kVersionMask);
  header.type = static_cast<std::uint16_t>(first & kTypeMask);
  header.length = u32(2);
  header.id = u32(6);
  if (header.version != 1 && header.version != 2)
    return Error{ErrorCode::kUnsupported,
                 "not a message of LLRP 1.0.1 or 1.1: version " + std::to_string(header.version), "header"};
  if (header.length < kHeaderBytes)
    return Error{ErrorCode::kMalformed, "length " + std::to_string(header.length) + " is less than a header's",
                 "header"};
  return header;
}

Result<Decoded> decode(std::span<const std::uint8_t> frame) {
  if (frame.size() < kHeaderBytes) return Error{ErrorCode::kMalformed, "ends within the header", "header"};
  const auto header = decode_header(frame);
  if (!header) return header.error();
  const auto& [version, type, length, id] = header.value();
  if (length != frame.size())
    return Error{ErrorCode::kMalformed,
                 "length " + std::to_string(length) + " is not that of the frame, " + std::to_string(frame.size()),
                 "header"};
  const auto body = frame.subspan(kHeaderBytes);
  Decoded decoded;
  decoded.message.id = id;
  Decoding decoding;
  if (!decode_any(type, body, decoding, decoded.message.body)) {
    if (std::find(std::begin(kOtherMessages), std::end(kOtherMessages), type) == std::end(kOtherMessages))
      return Error{ErrorCode::kUnsupported, "LLRP has no message type " + std::to_string(type), "header"};
    decoded.message.body = RawMessage{type, {body.begin(), body.end()}};
  }
  if (!decoding.error.empty()) return Error{ErrorCode::kMalformed, decoding.error, decoding.where};
  decoded.skipped = std::move(decoding.skipped);
  return decoded;
}

std::vector<std::uint8_t> encode(const Message& message) {
  Encoder encoder;
  std::visit(
      [&]<class T>(const T& body) {
        std::uint16_t type = 0;
        if constexpr (std::is_same_v<T, RawMessage>)
          type = body.type;
        else
          type = T::kName.type;
        encoder.put(static_cast<std::uint16_t>(1U << kVersionShift | type));
        encoder.put(std::uint32_t{0});
        encoder.put(message.id);
        if constexpr (std::is_same_v<T, RawMessage>)
          encoder.rest("", body.body);
        else
          T::fields(encoder, body);
      },
      message.body);
  const std::size_t size = encoder.size();
  encoder.patch(2, size, 4);
  return std::move(encoder).take();
}

std::string_view name_of(const Body& body) {
  return std::visit(
      []<class T>(const T&) -> std::string_view {
        if constexpr (std::is_same_v<T, RawMessage>)
          return "another message";
        else
          return T::kName.text;
      },
      body);
}

}  // namespace rfmvo::llrp
