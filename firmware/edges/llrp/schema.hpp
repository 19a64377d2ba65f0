// The one table of LLRP 1.0.1: every message and parameter is a struct that lists its fields, in wire order,
// once: `fields(v, s)` hands each field of `s` to the visitor `v`. Encoder, decoder and whoever prints are
// such visitors (the headers beside are tables, and longer than others for that):
//
//   v.value(name, x)       integers (big-endian), counted strings and arrays, bit strings, 96-bit EPCs
//   v.bits(name, x, n)     n bits of a byte or two, most significant first
//   v.reserved(n)          n bits that are zero
//   v.rest(name, bytes)    all that is left
//   v.child(x)             a parameter: T (required), std::optional<T>, std::vector<T>; T may be a std::variant
//
// Parameters whose type is below 128 are TV-encoded, all others TLV.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace rfmvo::llrp {

struct Name {
  std::uint16_t type;
  std::string_view text;  // as the standard writes it
};

struct BitString {
  std::uint16_t bits = 0;
  std::vector<std::uint8_t> bytes;  // (bits + 7) / 8
};

// A vendor's extension as it comes; vendor.hpp types the ones that matter here.
struct Custom {
  static constexpr Name kName{1023, "Custom"};
  std::uint32_t vendor_identifier = 0;
  std::uint32_t parameter_subtype = 0;
  std::vector<std::uint8_t> data;
  static void fields(auto& v, auto& s) {
    v.value("VendorIdentifier", s.vendor_identifier);
    v.value("ParameterSubtype", s.parameter_subtype);
    v.rest("Data", s.data);
  }
};

}  // namespace rfmvo::llrp
