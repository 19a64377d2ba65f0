// What a message is, from the fingerprint in front of it: every LCM message begins with the hash of its type.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace rfmvo::inspect {

// 0 beyond the end.
[[nodiscard]] std::int64_t big_endian_int64(std::span<const std::uint8_t> bytes, std::size_t offset);
[[nodiscard]] std::int64_t fingerprint_of(std::span<const std::uint8_t> message);

// "frame_t"; empty for types of others, and of other versions of this product.
[[nodiscard]] std::string_view type_name(std::int64_t fingerprint);

}  // namespace rfmvo::inspect
