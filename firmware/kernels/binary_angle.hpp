// Binary angles and their cosine and sine in fixed point: the scalar definitions. The SIMD kernels
// equal them to the last bit (fixed_point-inl.hpp; tests/kernels).
//
// Format:     angle uint16, 65536 = one turn: wrapping is integer overflow. Cosine int16, Q15.
// Range:      every angle is valid; |cosine| <= 1 (int16 -32768..32767).
// Rounding:   products round half up (kMulRound_q15). The code a stands for the middle of its interval,
//             (a + 1/2) / 65536 turns: what truncation to 16 bits leaves is then right on average, and the
//             fold below is odd, so that no product meets its only overflow, -32768 * -32768.
// Saturation: only where the last sum would leave int16, next to the peaks.
#pragma once

#include <algorithm>
#include <cstdint>

namespace rfmvo {

inline constexpr double kBinaryAnglesPerTurn = 65536.0;
inline constexpr double kOne_q15 = 32768.0;
// |cosine_q15(a) / 32768 - cos(2 pi a / 65536)|, all a: 2 of the polynomial, 1.3 of rounding and 1.5 of
// the half code, in units of the last place.
inline constexpr double kCosineMaxAbsError = 5.0 / kOne_q15;

// cos(pi/2 (1 - x)) = sin(pi/2 x) = x + x (k1 + k3 x^2 + k5 x^4), |x| <= 1: minimax fit, then the
// integers that keep the error of the integer formula smallest over all arguments.
inline constexpr std::int16_t kSine1_q15 = 18686;
inline constexpr std::int16_t kSine3_q15 = -21032;
inline constexpr std::int16_t kSine5_q15 = 2348;

inline constexpr std::int32_t kMulRound_q15 = 1 << 14;
inline constexpr std::uint16_t kQuarterTurn = 16384;

// a * b in Q15, not both -32768. What x86 calls pmulhrsw and Arm sqrdmulh.
[[nodiscard]] constexpr std::int16_t mul_q15(std::int16_t a, std::int16_t b) {
  return static_cast<std::int16_t>((std::int32_t{a} * b + kMulRound_q15) >> 15);
}

[[nodiscard]] constexpr std::int16_t cosine_q15(std::uint16_t angle) {
  const auto a = static_cast<std::int16_t>(angle);
  const auto folded = static_cast<std::int16_t>(a ^ (a >> 15));                 // 0 (peak) .. 32767 (trough)
  const auto x = static_cast<std::int16_t>(0x7FFF - 2 * std::int32_t{folded});  // odd, -32767..32767
  const std::int16_t xx = mul_q15(x, x);
  const auto k35 = static_cast<std::int16_t>(mul_q15(xx, kSine5_q15) + kSine3_q15);
  const auto k135 = static_cast<std::int16_t>(mul_q15(k35, xx) + kSine1_q15);
  return static_cast<std::int16_t>(std::clamp(std::int32_t{x} + mul_q15(x, k135), -32768, 32767));
}

[[nodiscard]] constexpr std::int16_t sine_q15(std::uint16_t angle) {
  return cosine_q15(static_cast<std::uint16_t>(angle - kQuarterTurn));
}

// No intermediate leaves int16: x^2 is in [0, 32766], so k35 in [k3, k3 + k5] and k135 in [k1 + k3, k1] and a few.
static_assert(kSine5_q15 > 0 && kSine3_q15 < 0 && kSine3_q15 >= -32768 && kSine3_q15 + kSine5_q15 < 0);
static_assert(kSine1_q15 > 0 && kSine1_q15 <= 32767 && kSine1_q15 + kSine3_q15 >= -32768);

// Q15 terms in an int32 sum: so many cannot overflow it.
inline constexpr std::int64_t kMaxTerms_q15 = 65535;
static_assert(kMaxTerms_q15 * 32768 <= INT64_C(2147483647));

}  // namespace rfmvo
