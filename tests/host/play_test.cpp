// The player on simulated time, and `rfmvo replay --bus` on a real bus.
#include <gmock/gmock.h>

#include <deque>

#include "edges/lcm_codec.hpp"
#include "host/host_command.hpp"
#include "host/real_bus.hpp"
#include "play/player.hpp"

namespace rfmvo {
namespace {

using play::Key;
using testing::Background;
using ::testing::ElementsAre;
using testing::expect_one_line;
using testing::in_quotes;
using testing::TemporaryFolder;

constexpr std::int64_t kMs = 1'000'000;

// Time passes only while somebody waits; keys come at their times.
class FakeDoor : public play::PlayDoor {
 public:
  struct Press {
    std::int64_t at_ns;
    Key key;
  };
  struct Sent {
    std::string channel;
    std::int64_t clock_ns, position_ns;
  };
  std::int64_t now_ns() override { return clock_ns; }
  Key wait_until(std::int64_t ns) override {
    if (!keys.empty() && keys.front().at_ns <= ns) {
      const Press press = keys.front();
      keys.pop_front();
      clock_ns = std::max(clock_ns, press.at_ns);
      return press.key;
    }
    if (ns == play::kForever_ns) return Key::kQuit;  // nobody would press a key any more
    clock_ns = std::max(clock_ns, ns);
    return Key::kNone;
  }
  Status send(const LogRecord& record, Duration position) override {
    sent.push_back({record.channel, clock_ns, position.ns});
    if (sent.size() == quit_after) keys.push_front({clock_ns, Key::kQuit});
    return Done{};
  }
  std::int64_t clock_ns = 5'000 * kMs;
  std::deque<Press> keys;
  std::vector<Sent> sent;
  std::size_t quit_after = 0;
};

class Play : public ::testing::Test {
 protected:
  // Messages A0 A1 ... at 0, 100, 200 ... ms.
  void SetUp() override {
    auto writer = LogFileWriter::create(log_);
    ASSERT_TRUE(writer.ok());
    const std::vector<std::uint8_t> data(4, 9);
    for (int k = 0; k < 10; ++k)
      ASSERT_TRUE(writer.value()->write("A" + std::to_string(k), 1'700'000'000'000'000 + k * 100'000, data).ok());
    ASSERT_TRUE(writer.value()->close().ok());
  }
  std::vector<std::string> channels() const {
    std::vector<std::string> names;
    for (const auto& sent : door_.sent) names.push_back(sent.channel);
    return names;
  }
  TemporaryFolder folder_;
  std::string log_ = folder_ / "run.lcmlog";
  FakeDoor door_;
  play::PlaySettings settings_;
};

TEST_F(Play, EveryMessageComesAtItsTimeWhateverTheSpeed) {
  for (const double speed : {0.5, 1.0, 4.0}) {
    FakeDoor door;
    settings_.speed = speed;
    const auto figures = play::play({log_}, settings_, door);
    ASSERT_TRUE(figures.ok());
    ASSERT_EQ(door.sent.size(), 10u);
    for (std::size_t k = 0; k < 10; ++k) {
      EXPECT_EQ(door.sent[k].position_ns, static_cast<std::int64_t>(k) * 100 * kMs);
      EXPECT_NEAR(static_cast<double>(door.sent[k].clock_ns - 5'000 * kMs) * speed,
                  static_cast<double>(door.sent[k].position_ns), 2.0);
    }
  }
}

TEST_F(Play, ASpanBeginsAtOnceAndBothEndsAreIn) {
  settings_.from = Duration{300 * kMs};
  settings_.to = Duration{600 * kMs};
  ASSERT_TRUE(play::play({log_}, settings_, door_).ok());
  EXPECT_THAT(channels(), ElementsAre("A3", "A4", "A5", "A6"));
  EXPECT_EQ(door_.sent.front().clock_ns, 5'000 * kMs);
}

TEST_F(Play, OnlyChannelsThatMatchAsAWhole) {
  settings_.channels = "A[13]|A";
  ASSERT_TRUE(play::play({log_}, settings_, door_).ok());
  EXPECT_THAT(channels(), ElementsAre("A1", "A3"));
}

TEST_F(Play, APauseStopsTheLogsTimeAndNothingIsSkipped) {
  door_.keys = {{5'250 * kMs, Key::kPause}, {9'000 * kMs, Key::kPause}};
  ASSERT_TRUE(play::play({log_}, settings_, door_).ok());
  ASSERT_EQ(door_.sent.size(), 10u);
  EXPECT_EQ(door_.sent[2].clock_ns, 5'200 * kMs);
  EXPECT_EQ(door_.sent[3].clock_ns, 9'000 * kMs) << "the next one, when it goes on";
  EXPECT_EQ(door_.sent[4].clock_ns, 9'100 * kMs) << "and the others at their distance";
}

TEST_F(Play, AStepSendsOneAndPauses) {
  settings_.paused = true;
  door_.keys = {{6'000 * kMs, Key::kStep}, {7'000 * kMs, Key::kStep}};
  ASSERT_TRUE(play::play({log_}, settings_, door_).ok());
  EXPECT_THAT(channels(), ElementsAre("A0", "A1"));
  EXPECT_EQ(door_.sent[1].clock_ns, 7'000 * kMs);
}

TEST_F(Play, ALoopBeginsAgain) {
  settings_.loop = true;
  settings_.from = Duration{800 * kMs};
  door_.quit_after = 5;
  const auto figures = play::play({log_}, settings_, door_);
  ASSERT_TRUE(figures.ok());
  EXPECT_THAT(channels(), ElementsAre("A8", "A9", "A8", "A9", "A8"));
  EXPECT_EQ(figures.value().rounds, 2u);
}

TEST_F(Play, TwoLogsComeInTheOrderOfTheirTimes) {
  const std::string other = folder_ / "other.lcmlog";
  auto writer = LogFileWriter::create(other);
  ASSERT_TRUE(writer.ok());
  const std::vector<std::uint8_t> data(4, 9);
  for (const int ms : {-50, 100, 150, 880})
    ASSERT_TRUE(writer.value()->write("B", 1'700'000'000'000'000 + ms * 1'000, data).ok());
  ASSERT_TRUE(writer.value()->close().ok());
  ASSERT_TRUE(play::play({log_, other}, settings_, door_).ok());
  EXPECT_THAT(channels(), ElementsAre("B", "A0", "A1", "B", "B", "A2", "A3", "A4", "A5", "A6", "A7", "A8", "B", "A9"));
  EXPECT_EQ(door_.sent.back().position_ns, 950 * kMs) << "since the first record of both";
}

TEST_F(Play, NothingToSendIsAnErrorAlsoInALoop) {
  settings_.loop = true;
  settings_.channels = "NONE";
  const auto figures = play::play({log_}, settings_, door_);
  ASSERT_FALSE(figures.ok());
  EXPECT_THAT(figures.error().text(), ::testing::HasSubstr("holds no message"));
}

TEST(PlayOnBus, WhatWasRecordedIsHeardByTheRecorder) {
  if (!testing::has_multicast()) GTEST_SKIP() << "this machine has no multicast";
  const TemporaryFolder folder;
  const std::string url = in_quotes(testing::bus_url());
  testing::write_journal(folder / "run.lcmlog", testing::short_run(20));
  Background logger(RFMVO_COMMAND " log " + in_quotes(folder / "heard.lcmlog") + " --url " + url, folder / "out",
                    folder / "err");
  ASSERT_TRUE(logger.said("recording")) << logger.err();
  const auto played =
      testing::rfmvo("replay " + in_quotes(folder / "run.lcmlog") + " --bus " + url + " --speed 20 </dev/null");
  ASSERT_EQ(played.exit_code, 0) << played.err;
  ASSERT_EQ(logger.end(SIGINT), 0);
  const auto original = LogFileReader::open(folder / "run.lcmlog"),
             heard = LogFileReader::open(folder / "heard.lcmlog");
  ASSERT_TRUE(original.ok() && heard.ok());
  while (true) {
    const auto a = original.value()->next(), b = heard.value()->next();
    ASSERT_TRUE(a.ok() && b.ok());
    ASSERT_EQ(a.value().has_value(), b.value().has_value());
    if (!a.value()) break;
    EXPECT_EQ(a.value()->channel, b.value()->channel);
    EXPECT_EQ(a.value()->data, b.value()->data);
  }
}

TEST(PlayOnBus, BadInputIsOneLine) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "run.lcmlog", testing::short_run(3));
  const std::string run = "replay " + in_quotes(folder / "run.lcmlog");
  expect_one_line(testing::rfmvo(run), "--out or --bus is required", 2);
  expect_one_line(testing::rfmvo(run + " --bus --out x"), "excludes", 2);
  expect_one_line(testing::rfmvo(run + " --out x --loop"), "--bus", 2);
  expect_one_line(testing::rfmvo(run + " --bus --speed max"), "--speed", 2);
  expect_one_line(testing::rfmvo(run + " --bus --start-s 3 --end-s 2"), "--end-s", 2);
  expect_one_line(testing::rfmvo(run + " --bus udpm://10.0.0.1:7667"), "not a multicast address");
  expect_one_line(testing::rfmvo("replay /nowhere/x.lcmlog --bus memq://"), "/nowhere/x.lcmlog: no such file");
}

}  // namespace
}  // namespace rfmvo
