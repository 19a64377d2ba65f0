#include "kernels/binary_angle.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rfmvo {
namespace {

constexpr double kTwoPi = 6.283185307179586476925;

TEST(BinaryAngle, CosineAndSineOfAllAnglesAreWithinTheBoundAndTheBoundIsTight) {
  double worst = 0.0;
  for (int a = 0; a < 65536; ++a) {
    const auto angle = static_cast<std::uint16_t>(a);
    const double rad = kTwoPi * a / 65536.0;
    worst = std::max(worst, std::abs(cosine_q15(angle) / kOne_q15 - std::cos(rad)));
    worst = std::max(worst, std::abs(sine_q15(angle) / kOne_q15 - std::sin(rad)));
  }
  EXPECT_LE(worst, kCosineMaxAbsError);
  EXPECT_GE(worst, 0.1 * kCosineMaxAbsError);
}

// What makes an angle that is truncated, not rounded, right on average.
TEST(BinaryAngle, CosineIsSymmetricAboutTheMiddleOfACode) {
  for (int a = 0; a < 65536; ++a)
    EXPECT_EQ(cosine_q15(static_cast<std::uint16_t>(a)), cosine_q15(static_cast<std::uint16_t>(-1 - a)));
}

TEST(BinaryAngle, HalfATurnFlipsTheSignUpToSaturation) {
  for (int a = 0; a < 65536; ++a) {
    const int here = cosine_q15(static_cast<std::uint16_t>(a)),
              there = cosine_q15(static_cast<std::uint16_t>(a + 32768));
    EXPECT_NEAR(here, -there, 2);  // products round half up: not odd by one each
  }
}

TEST(BinaryAngle, ErrorsAverageOutOverTheTurn) {
  double c = 0.0, s = 0.0;
  for (int a = 0; a < 65536; ++a) {
    c += cosine_q15(static_cast<std::uint16_t>(a));
    s += sine_q15(static_cast<std::uint16_t>(a));
  }
  EXPECT_LT(std::abs(c) / 65536.0, 0.5);
  EXPECT_LT(std::abs(s) / 65536.0, 0.5);
}

}  // namespace
}  // namespace rfmvo
