// LLRP 1.0.1 on the wire: bytes to typed messages and back. Pure. Every type and field is declared once, in the
// headers beside (schema.hpp says how).
//
// A header of LLRP 1.1 is taken as well. Unknown TLV parameters are passed over by their length and named in
// Decoded::skipped; parameters that are known but have no business where they stand, that are missing, come
// twice or reach beyond what holds them, are errors. So is an unknown TV parameter: its length is unknown.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "edges/llrp/messages.hpp"

namespace rfmvo::llrp {

inline constexpr std::size_t kHeaderBytes = 10;

struct Header {
  std::uint8_t version = 1;  // 1: LLRP 1.0.1, 2: LLRP 1.1
  std::uint16_t type = 0;
  std::uint32_t length = 0;  // of the whole frame
  std::uint32_t id = 0;
};
// bytes: at least kHeaderBytes. Errors: kUnsupported for a version that is not 1 or 2, kMalformed for a length
// below the header's.
[[nodiscard]] Result<Header> decode_header(std::span<const std::uint8_t> bytes);

struct Decoded {
  Message message;
  std::vector<std::string> skipped;  // "ParentName: unknown parameter 900", in order
};
// One whole frame. Errors: kMalformed with where = the path of names to the culprit; kUnsupported for a
// message type that LLRP does not have.
[[nodiscard]] Result<Decoded> decode(std::span<const std::uint8_t> frame);

// Sizes that the wire cannot hold (65535 bytes of a parameter) are a bug of the caller.
[[nodiscard]] std::vector<std::uint8_t> encode(const Message& message);

[[nodiscard]] std::string_view name_of(const Body& body);
// "ROSpec", or "parameter 900".
[[nodiscard]] std::string parameter_name(std::uint16_t type);
// "M_ParameterError: ROSpec (P_FieldError), field 3 (A_OutOfRange): the reader's own words".
[[nodiscard]] std::string status_text(const LLRPStatus& status);
[[nodiscard]] std::string status_code_name(std::uint16_t code);

}  // namespace rfmvo::llrp
