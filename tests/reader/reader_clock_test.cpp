#include "edges/reader_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rfmvo {
namespace {

constexpr std::int64_t kMs = 1'000'000, kSecond = 1'000'000'000;
constexpr DeviceTime kStart{1'767'225'600 * kSecond};  // 2026-01-01
constexpr ReaderTime kYear2000{946'684'800 * kSecond};

// A reader whose clock runs `drift` fast, and a network with a least delay and an exponential rest.
class World {
 public:
  explicit World(double drift, ReaderTime origin = kYear2000) : drift_(drift), origin_(origin) {}
  [[nodiscard]] ReaderTime stamp(double t_s) const {
    return origin_ + Duration::from_seconds(t_s * (1.0 + drift_) + step_s_);
  }
  // Reads at 50/s from `from_s` to `to_s`; true steps that the filter tells of.
  std::vector<double> run(ReaderClockFilter& filter, double from_s, double to_s) {
    std::exponential_distribution<double> delay(1.0 / mean_delay_s_);
    std::vector<double> steps_s;
    for (double t_s = from_s; t_s < to_s; t_s += 0.02) {
      const DeviceTime arrival = kStart + Duration::from_seconds(t_s + delay(random_));
      if (const auto step = filter.observe(stamp(t_s), arrival)) steps_s.push_back(step->seconds());
    }
    return steps_s;
  }
  [[nodiscard]] double error_s(const ReaderClockFilter& filter, double t_s) const {
    return (filter.to_device(stamp(t_s)) - (kStart + Duration::from_seconds(t_s))).seconds();
  }
  double step_s_ = 0.0;
  double mean_delay_s_ = 0.003;

 private:
  double drift_;
  ReaderTime origin_;
  std::mt19937_64 random_{7};
};

// 50 reads a second: the least of an exponential delay of 3 ms is 0.06 ms on average per second.
TEST(ReaderClock, FindsOffsetAndDriftOfAReaderThatIsDecadesOff) {
  for (const double drift : {0.0, 40e-6, -90e-6}) {
    World world(drift);
    ReaderClockFilter filter;
    EXPECT_TRUE(world.run(filter, 0.0, 100.0).empty());
    EXPECT_NEAR(world.error_s(filter, 100.0), 0.0, 0.3e-3) << drift;
    EXPECT_NEAR(filter.drift(), -drift, 3e-6) << "of the offset, so with the other sign";
    EXPECT_LT(filter.sigma().seconds(), 0.3e-3);
    EXPECT_GT(filter.sigma().seconds(), 0.02e-3);
  }
}

TEST(ReaderClock, IsUsableFromTheFirstReadAndSaysHowLittleItKnows) {
  World world(0.0);
  ReaderClockFilter filter;
  EXPECT_FALSE(filter.known());
  (void)world.run(filter, 0.0, 0.01);
  ASSERT_TRUE(filter.known());
  EXPECT_GE(filter.sigma().seconds(), 1e-3);
  EXPECT_GE(world.error_s(filter, 0.0), 0.0) << "the first delay is all that is known";
}

// No read is placed later than it arrived, whatever the delays.
TEST(ReaderClock, NeverPlacesAReadAfterItsArrivalByMoreThanItsOwnError) {
  World world(80e-6);
  ReaderClockFilter filter;
  std::exponential_distribution<double> delay(1.0 / 0.003);
  std::mt19937_64 random(3);
  for (double t_s = 0.0; t_s < 60.0; t_s += 0.05) {
    const DeviceTime arrival = kStart + Duration::from_seconds(t_s + delay(random));
    (void)filter.observe(world.stamp(t_s), arrival);
    // Until the drift is known, 20 s of 80 ppm; then microseconds.
    EXPECT_LT((filter.to_device(world.stamp(t_s)) - arrival).seconds(), t_s < 21.0 ? 1.7e-3 : 0.1e-3) << t_s;
  }
}

TEST(ReaderClock, NoticesAClockThatWasSetForwardAtOnce) {
  World world(10e-6);
  ReaderClockFilter filter;
  EXPECT_TRUE(world.run(filter, 0.0, 30.0).empty());
  world.step_s_ = 26.0 * 365.25 * 86400.0;  // NTP came up
  const auto steps_s = world.run(filter, 30.0, 40.0);
  ASSERT_EQ(steps_s.size(), 1u);
  EXPECT_NEAR(steps_s[0], world.step_s_, 0.02);
  EXPECT_NEAR(world.error_s(filter, 40.0), 0.0, 1e-3);
}

TEST(ReaderClock, NoticesAClockThatWasSetBackByATenthWithinSomeSeconds) {
  World world(10e-6);
  ReaderClockFilter filter;
  EXPECT_TRUE(world.run(filter, 0.0, 30.0).empty());
  world.step_s_ = -0.1;
  EXPECT_TRUE(world.run(filter, 30.0, 31.0).empty()) << "may be the network";
  const auto steps_s = world.run(filter, 31.0, 33.0);
  ASSERT_EQ(steps_s.size(), 1u);
  EXPECT_NEAR(steps_s[0], -0.1, 0.002);
  EXPECT_NEAR(world.error_s(filter, 33.0), 0.0, 1e-3);
}

TEST(ReaderClock, DoesNotTakeABurstOfDelayForAStep) {
  World world(10e-6);
  ReaderClockFilter filter;
  (void)world.run(filter, 0.0, 30.0);
  world.mean_delay_s_ = 0.3;
  EXPECT_TRUE(world.run(filter, 30.0, 35.0).empty());
  world.mean_delay_s_ = 0.003;
  EXPECT_TRUE(world.run(filter, 35.0, 40.0).empty());
  EXPECT_NEAR(world.error_s(filter, 40.0), 0.0, 0.5e-3);
}

TEST(ReaderClock, DoesNotTakeAHeldUpBeginningForAStep) {
  World world(10e-6);
  ReaderClockFilter filter;
  world.mean_delay_s_ = 2.0;
  EXPECT_TRUE(world.run(filter, 0.0, 0.2).empty());
  world.mean_delay_s_ = 0.003;
  EXPECT_TRUE(world.run(filter, 0.2, 10.0).empty()) << "the stamps only stopped being late";
  EXPECT_NEAR(world.error_s(filter, 10.0), 0.0, 0.5e-3);
}

TEST(ReaderClock, DecidesByTheFirstStampAfterAReconnection) {
  World world(0.0);
  ReaderClockFilter filter;
  (void)world.run(filter, 0.0, 30.0);
  filter.suspect();
  EXPECT_TRUE(world.run(filter, 30.0, 31.0).empty()) << "same clock";
  filter.suspect();
  world.step_s_ = -0.2;  // restarted, and set less well
  const auto steps_s = world.run(filter, 31.0, 32.0);
  ASSERT_EQ(steps_s.size(), 1u);
  EXPECT_NEAR(world.error_s(filter, 32.0), 0.0, 5e-3);
}

TEST(ReaderClock, FollowsAReaderThatCountsItsUptime) {
  World world(0.0, ReaderTime{12 * kMs});
  ReaderClockFilter filter;
  EXPECT_TRUE(world.run(filter, 0.0, 30.0).empty());
  EXPECT_NEAR(world.error_s(filter, 30.0), 0.0, 0.3e-3);
}

}  // namespace
}  // namespace rfmvo
