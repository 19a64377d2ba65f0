#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "rf/epc.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

TEST(Phase, TwelveBitsOfAReaderMapExactly) {
  for (int raw = 0; raw < 4096; ++raw) {
    const Phase phase = Phase::from_rad(raw * (kTwoPi / 4096.0));
    EXPECT_EQ(phase.turn_q16, raw * 16);
    EXPECT_EQ(phase.rad(), raw * (kTwoPi / 4096.0));
  }
}

TEST(Phase, EveryValueSurvivesTheRoundTrip) {
  for (int q = 0; q < 65536; q += 7) {
    const Phase phase{static_cast<std::uint16_t>(q)};
    EXPECT_EQ(Phase::from_rad(phase.rad()), phase);
    EXPECT_GE(phase.rad(), 0.0);
    EXPECT_LT(phase.rad(), kTwoPi);
  }
}

TEST(Phase, WholeTurnsChangeNothing) {
  for (int q = 1; q < 65536; q += 501)
    for (int turns = -50; turns <= 50; turns += 7) {
      const double rad = (q + 0.25) * (kTwoPi / 65536.0);  // away from a rounding edge
      EXPECT_EQ(Phase::from_rad(rad + turns * kTwoPi).turn_q16, q);
    }
}

TEST(Phase, RoundsToTheNearestStepAndWrapsAtAFullTurn) {
  constexpr double kStep = kTwoPi / 65536.0;
  EXPECT_EQ(Phase::from_rad(0.4 * kStep).turn_q16, 0);
  EXPECT_EQ(Phase::from_rad(0.6 * kStep).turn_q16, 1);
  EXPECT_EQ(Phase::from_rad(-0.4 * kStep).turn_q16, 0);
  EXPECT_EQ(Phase::from_rad(-0.6 * kStep).turn_q16, 65535);
  EXPECT_EQ(Phase::from_rad(kTwoPi - 0.4 * kStep).turn_q16, 0);
}

TEST(WrapRad, StaysWithinHalfATurnAndIsTheSameAngle) {
  for (int i = -4000; i <= 4000; ++i) {
    const double x = 0.01 * i, w = wrap_rad(x);
    EXPECT_LE(std::abs(w), kPi);
    // kTwoPi is a turn to 2.4e-16; some seven turns of 40 rad.
    EXPECT_NEAR(std::remainder((x - w) / kTwoPi, 1.0), 0.0, 1e-14);
  }
  EXPECT_EQ(wrap_rad(kPi / 2), kPi / 2);
  EXPECT_EQ(std::abs(wrap_rad(kPi)), kPi);
}

TEST(Epc, HexSurvivesTheRoundTripAtEveryLength) {
  for (std::size_t size = 1; size <= Epc::kMaxBytes; ++size) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(37 * i + 11 * size));
    const auto epc = Epc::from_bytes(bytes);
    ASSERT_TRUE(epc.ok());
    EXPECT_EQ(epc.value().bytes().size(), size);
    const auto again = Epc::from_hex(epc.value().hex());
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(again.value(), epc.value());
  }
}

TEST(Epc, HasOneTo62Bytes) {
  const std::vector<std::uint8_t> many(63, 1);
  EXPECT_FALSE(Epc::from_bytes({}).ok());
  EXPECT_FALSE(Epc::from_bytes(many).ok());
  EXPECT_FALSE(Epc::from_hex("").ok());
  EXPECT_FALSE(Epc::from_hex(std::string(126, 'A')).ok());
  EXPECT_TRUE(Epc::from_hex(std::string(124, 'A')).ok());
}

TEST(Epc, IsWrittenInUpperCaseAndReadInBoth) {
  const auto lower = Epc::from_hex("e280f00d"), upper = Epc::from_hex("E280F00D");
  ASSERT_TRUE(lower.ok() && upper.ok());
  EXPECT_EQ(lower.value(), upper.value());
  EXPECT_EQ(lower.value().hex(), "E280F00D");
}

TEST(Epc, RefusesWhatIsNotHexAndNamesIt) {
  for (const char* text : {"E2G0", "E2 0", "0xE2", "-1E2", "+1", "E", "E28", "E2\n0", "zz", " E2 "}) {
    const auto epc = Epc::from_hex(text);
    ASSERT_FALSE(epc.ok()) << text;
    EXPECT_EQ(epc.error().where, text);
  }
}

TEST(Epc, OfDifferentLengthsAreDifferent) {
  const auto one = Epc::from_hex("AA"), two = Epc::from_hex("AA00");
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_NE(one.value(), two.value());
}

}  // namespace
}  // namespace rfmvo
