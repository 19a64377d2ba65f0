#include "rf/epc.hpp"

#include <algorithm>
#include <charconv>

namespace rfmvo {

Result<Epc> Epc::from_bytes(std::span<const std::uint8_t> bytes) {
  if (bytes.empty() || bytes.size() > kMaxBytes)
    return Error{ErrorCode::kOutOfRange, "an EPC has 1 to 62 bytes, not " + std::to_string(bytes.size()), "epc"};
  Epc epc;
  epc.size_ = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), epc.bytes_.begin());
  return epc;
}

Result<Epc> Epc::from_hex(std::string_view hex) {
  std::array<std::uint8_t, kMaxBytes> bytes{};
  if (hex.empty() || hex.size() % 2 != 0 || hex.size() / 2 > kMaxBytes)
    return Error{ErrorCode::kMalformed, "an EPC has an even number of hex digits, 2 to 124", std::string(hex)};
  for (std::size_t i = 0; i < hex.size() / 2; ++i) {
    const char* first = hex.data() + 2 * i;
    const auto [end, error] = std::from_chars(first, first + 2, bytes[i], 16);
    if (error != std::errc{} || end != first + 2)
      return Error{ErrorCode::kMalformed, "not a hex digit in an EPC", std::string(hex)};
  }
  return from_bytes({bytes.data(), hex.size() / 2});
}

std::string Epc::hex() const {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  std::string text;
  text.reserve(2 * size_);
  for (const std::uint8_t byte : bytes()) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace rfmvo
