// The Electronic Product Code of a tag: 1..62 bytes (EPC Gen2: at most 496 bits).
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace rfmvo {

class Epc {
 public:
  static constexpr std::size_t kMaxBytes = 62;

  Epc() = default;
  [[nodiscard]] static Result<Epc> from_bytes(std::span<const std::uint8_t> bytes);
  [[nodiscard]] static Result<Epc> from_hex(std::string_view hex);

  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return {bytes_.data(), size_}; }
  [[nodiscard]] std::string hex() const;  // upper case, two digits a byte
  auto operator<=>(const Epc&) const = default;

 private:
  std::uint8_t size_ = 0;
  std::array<std::uint8_t, kMaxBytes> bytes_{};  // unused bytes stay zero, so comparison is by value
};

}  // namespace rfmvo
