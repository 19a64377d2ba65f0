// RF phase as a binary angle: 65536 = one turn, so wrapping is integer overflow and a reader's
// 12 bits (Impinj: 0..4095 = one turn) map exactly.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/units.hpp"

namespace rfmvo {

// x wrapped to [-pi, pi], to the rounding of x. Several times faster than std::remainder.
[[nodiscard]] inline double wrap_rad(double x) { return x - kTwoPi * std::nearbyint(x * (1.0 / kTwoPi)); }

struct Phase {
  std::uint16_t turn_q16 = 0;  // phase / (2 pi) * 65536, modulo 65536

  [[nodiscard]] double rad() const { return static_cast<double>(turn_q16) * (kTwoPi / 65536.0); }  // [0, 2 pi)
  [[nodiscard]] static Phase from_rad(double rad) {
    return {static_cast<std::uint16_t>(static_cast<std::int64_t>(std::llround(rad * (65536.0 / kTwoPi))) & 0xFFFF)};
  }
  bool operator==(const Phase&) const = default;
};

}  // namespace rfmvo
