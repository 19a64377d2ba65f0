// Physical constants and the conversions used at the edges. SI inside.
#pragma once

#include <numbers>

namespace rfmvo {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;
inline constexpr double kSpeedOfLight_m_s = 299'792'458.0;  // CODATA, exact

// Phase per metre of distance, there and back: 4 pi f / c.
[[nodiscard]] constexpr double wavenumber_rad_m(double frequency_hz) {
  return 2.0 * kTwoPi * frequency_hz / kSpeedOfLight_m_s;
}

[[nodiscard]] constexpr double rad_from_deg(double deg) { return deg * kPi / 180.0; }
[[nodiscard]] constexpr double deg_from_rad(double rad) { return rad * 180.0 / kPi; }

}  // namespace rfmvo
