// rfmvo status: a box that is simulated, on simulated time, and on a real bus.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "edges/lcm_codec.hpp"
#include "host/host_command.hpp"
#include "host/real_bus.hpp"
#include "status/box_status.hpp"

namespace rfmvo {
namespace {

using testing::Background;
using testing::expect_one_line;
using ::testing::HasSubstr;
using testing::in_quotes;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::TemporaryFolder;
using Json = nlohmann::json;

constexpr std::int64_t kSecond = 1'000'000'000;

BusMessage message_of(const Estimate& estimate) {
  const LcmMessage m = encode(estimate, "RFMVO_").front();
  return {m.channel, m.data};
}

Health healthy(int second) {
  Health health;
  health.time = DeviceTime{1'700'000'000 * kSecond + second * kSecond};
  health.vo_status = VoStatus::kTracking;
  health.frames = static_cast<std::uint64_t>(30 * second);
  health.reads = static_cast<std::uint64_t>(80 * second);
  return health;
}

class Box : public ::testing::Test {
 protected:
  void hear(const Estimate& estimate, std::int64_t now_s) { status_.on(message_of(estimate), now_s * kSecond); }
  [[nodiscard]] auto problems(std::int64_t now_s) const { return status_.problems(now_s * kSecond); }
  status::BoxStatus status_{"RFMVO_"};
};

TEST_F(Box, IsUnknownUntilItSpeaks) {
  EXPECT_THAT(problems(1), ::testing::ElementsAre("nothing heard of a box"));
  hear(healthy(1), 1);
  EXPECT_THAT(problems(1), IsEmpty());
}

TEST_F(Box, RatesAreThoseOfItsCounters) {
  hear(healthy(1), 1);
  EXPECT_FALSE(status_.rates());
  hear(healthy(3), 2);  // by its own clock, whenever it comes
  ASSERT_TRUE(status_.rates());
  EXPECT_NEAR(status_.rates()->frames_hz, 30.0, 1e-9);
  EXPECT_NEAR(status_.rates()->reads_hz, 80.0, 1e-9);
}

TEST_F(Box, SilenceIsAProblem) {
  hear(healthy(1), 1);
  EXPECT_THAT(problems(5), IsEmpty());
  EXPECT_THAT(problems(20), ::testing::ElementsAre("nothing heard for 19 s"));
}

TEST_F(Box, ALostOdometryAndAReaderThatDoesNotReadAreProblems) {
  Health health = healthy(1);
  health.vo_status = VoStatus::kLost;
  health.reader.time = health.time;
  hear(health, 1);
  EXPECT_THAT(problems(1), ::testing::ElementsAre("odometry LOST", "reader is not reading"));
}

TEST_F(Box, ANewRunForgetsTheTagsOfTheOld) {
  hear(testing::one_of_each_estimate()[1], 1);
  hear(healthy(10), 2);
  EXPECT_EQ(status_.tags().size(), 1u);
  hear(healthy(1), 3);
  EXPECT_EQ(status_.tags().size(), 0u);
}

TEST_F(Box, WhatIsBrokenIsCountedAndPassedOver) {
  status_.on({"RFMVO_TAG", {1, 2, 3}}, 0);
  status_.on({"ROBOT", {1, 2, 3}}, 0);
  EXPECT_EQ(status_.broken(), 1u);
  for (const LcmMessage& m : encode(testing::one_of_each_estimate()[3], "RFMVO_")) status_.on({m.channel, m.data}, 0);
  EXPECT_EQ(status_.broken(), 1u) << "POSE beside METRIC_POSE is no mistake";
}

TEST_F(Box, ScreenHasColoursOnlyIfAskedForAndNoMoreTagsThanFit) {
  auto tag = std::get<TagEstimate>(testing::one_of_each_estimate()[1]);
  for (std::uint8_t k = 0; k < 50; ++k) {
    tag.epc = Epc::from_bytes(std::vector<std::uint8_t>{0xAB, k}).value();
    hear(tag, 1);
  }
  hear(healthy(1), 1);
  status::View view;
  view.tag_rows = 7;
  const std::string plain = status::to_screen(status_, view);
  EXPECT_THAT(plain, Not(HasSubstr("\033")));
  EXPECT_THAT(plain, HasSubstr("and 43 more"));
  EXPECT_THAT(plain, HasSubstr("AB06"));
  EXPECT_THAT(plain, Not(HasSubstr("AB07")));
  view.colours = true;
  EXPECT_THAT(status::to_screen(status_, view), HasSubstr("\033[32mwell\033[0m"));
  const std::string line = status::to_line(status_, status::View{});
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
}

TEST(StatusOnBus, SaysOnceWhatABoxSaid) {
  if (!testing::has_multicast()) GTEST_SKIP() << "this machine has no multicast";
  const TemporaryFolder folder;
  const std::string url = testing::bus_url();
  lcm::LCM bus(url);
  Background once(RFMVO_COMMAND " status --once --json --wait-s 60 --url " + in_quotes(url), folder / "out",
                  folder / "err");
  // Nothing says when it listens: so the box speaks until it has been heard.
  int code = -1;
  std::thread waiting([&] { code = once.end(0); });
  std::atomic<bool> done{false};
  std::thread speaking([&] {
    for (int second = 1; !done; ++second) {
      for (const Estimate& estimate : {Estimate(healthy(second)), testing::one_of_each_estimate()[1]}) {
        const BusMessage m = message_of(estimate);
        bus.publish(m.channel, m.data.data(), static_cast<unsigned>(m.data.size()));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  waiting.join();
  done = true;
  speaking.join();
  ASSERT_EQ(code, 0) << once.err();
  const Json json = Json::parse(once.out());
  EXPECT_EQ(json.at("well"), true);
  EXPECT_NEAR(json.at("rates").at("reads_hz").get<double>(), 80.0, 1e-9);
  EXPECT_EQ(json.at("tags").at(0).at("epc"), "E28011602000600D3CA80AE1");
  EXPECT_EQ(json.at("tags").at(0).at("status"), "MIRROR");
}

TEST(StatusOnBus, ASilentBusIsOneLine) {
  if (!testing::has_multicast()) GTEST_SKIP() << "this machine has no multicast";
  const std::string url = in_quotes(testing::bus_url());
  expect_one_line(testing::rfmvo("status --once --wait-s 0.1 --url " + url), "no box was heard within 0.1 s");
  expect_one_line(testing::rfmvo("status --url udpm://1.2.3.4:5"), "not a multicast address");
  expect_one_line(testing::rfmvo("status --wait-s -1"), "--wait-s", 2);
}

}  // namespace
}  // namespace rfmvo
