#include <gtest/gtest.h>

#include <cmath>

#include "simulate/random.hpp"

namespace rfmvo::simulate {
namespace {

TEST(SimulateRandom, NormalNumbersHaveMeanZeroAndVarianceOne) {
  Random random(7, "test");
  constexpr int kCount = 100'000;
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  // Five standard errors: 1, sqrt(2) and sqrt(96) over sqrt(n).
  EXPECT_NEAR(sum / kCount, 0.0, 5.0 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1.0, 5.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(fourth / kCount, 3.0, 5.0 * std::sqrt(96.0 / kCount));
}

TEST(SimulateRandom, StreamsOfDifferentPurposeIndexOrSeedAreUnrelated) {
  const Random reference(1, "a");
  for (Random other : {Random(1, "b"), Random(1, "a", 1), Random(2, "a")}) {
    Random same = reference;
    constexpr int kCount = 10'000;
    double product = 0.0;
    for (int i = 0; i < kCount; ++i) product += same.normal() * other.normal();
    EXPECT_NEAR(product / kCount, 0.0, 5.0 / std::sqrt(kCount));
  }
}

TEST(SimulateRandom, EqualStreamsAreEqual) {
  Random a(5, "x", 3), b(5, "x", 3);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.normal(), b.normal());
}

}  // namespace
}  // namespace rfmvo::simulate
