// rfmvo info: what is said of a log that was made to a plan.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "edges/journal.hpp"
#include "edges/log_file.hpp"
#include "host/host_command.hpp"
#include "inspect/run_info.hpp"
#include "support/evaluate_world.hpp"

namespace rfmvo {
namespace {

using testing::expect_one_line;
using ::testing::HasSubstr;
using testing::in_quotes;
using testing::TemporaryFolder;
using Json = nlohmann::json;

constexpr std::int64_t kFramePeriod_us = 50'000;

// Frames at 20 Hz whose counters are given: what a camera sent that dropped some.
std::vector<Event> frames_numbered(const std::vector<std::int64_t>& sequences) {
  std::vector<Event> events = {testing::one_of_each_event()[0]};
  const DeviceTime start = time_of(events[0]);
  for (const std::int64_t sequence : sequences) {
    Frame frame = std::get<Frame>(testing::one_of_each_event()[1]);
    frame.sequence = sequence;
    frame.time = start + Duration{sequence * kFramePeriod_us * 1000};
    events.push_back(frame);
  }
  return events;
}

class Info : public ::testing::Test {
 protected:
  Json info_of(const std::vector<Event>& events) {
    testing::write_journal(log_, events);
    const auto result = testing::rfmvo("info " + in_quotes(log_) + " --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
  }
  TemporaryFolder folder_;
  std::string log_ = folder_ / "run.lcmlog";
};

TEST_F(Info, CountsEveryMessageOfEveryChannel) {
  const auto events = testing::one_of_each_event();
  const Json info = info_of(events);
  EXPECT_EQ(info.at("messages"), events.size());
  std::uint64_t sum = 0;
  for (const auto& [name, channel] : info.at("channels").items()) {
    sum += channel.at("messages").get<std::uint64_t>();
    EXPECT_EQ(
        name, "RFMVO_" +
                  [&] {
                    std::string upper = channel.at("type").get<std::string>();
                    upper.resize(upper.size() - 2);  // "_t"
                    std::transform(upper.begin(), upper.end(), upper.begin(), ::toupper);
                    return upper;
                  }())
        << "each type has the channel of its name";
  }
  EXPECT_EQ(sum, events.size());
  EXPECT_EQ(info.at("faults").at(0).at("text"), "no answer");
  EXPECT_EQ(info.at("reader").at("connections"), 3);
  EXPECT_EQ(info.at("start").at("config").at("estimator.pose_source"), "poses");
  EXPECT_EQ(info.at("start").at("antennas").size(), 2u);
}

TEST_F(Info, RateAndDurationAreThoseOfTheFrames) {
  const Json frames = info_of(frames_numbered({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11})).at("channels").at("RFMVO_FRAME");
  EXPECT_NEAR(frames.at("rate_hz").get<double>(), 20.0, 1e-9);
  EXPECT_NEAR(frames.at("longest_gap_s").get<double>(), 0.05, 1e-9);
  EXPECT_EQ(frames.at("lost"), 0);
}

TEST_F(Info, LossIsWhatTheSenderCountedAndNobodyRecorded) {
  const Json info = info_of(frames_numbered({5, 6, 10, 11, 12, 14}));  // 7 8 9 13
  const Json& frames = info.at("channels").at("RFMVO_FRAME");
  EXPECT_EQ(frames.at("lost"), 4);
  EXPECT_NEAR(frames.at("longest_gap_s").get<double>(), 0.2, 1e-9);
  EXPECT_NEAR(frames.at("longest_gap_at_s").get<double>(), 0.3, 1e-9) << "after number 6";
  EXPECT_TRUE(info.at("channels").at("RFMVO_START").at("lost").is_null()) << "does not count itself";
}

TEST_F(Info, ACameraThatBeganAnewLostNothing) {
  EXPECT_EQ(info_of(frames_numbered({7, 8, 1, 2, 3})).at("channels").at("RFMVO_FRAME").at("lost"), 0);
}

TEST_F(Info, TextNamesChannelsSettingsAndAntennas) {
  testing::write_journal(log_, testing::one_of_each_event());
  const auto result = testing::rfmvo("info " + in_quotes(log_));
  EXPECT_EQ(result.exit_code, 0);
  for (const char* word :
       {"RFMVO_TAG_READ", "tag_read_t", "estimator.pose_source = poses", "640 x 480", "antenna 2", "reader: no answer"})
    EXPECT_THAT(result.out, HasSubstr(word));
}

TEST_F(Info, RecordedConfigurationGoesBackIntoAReplay) {
  testing::write_journal(log_, testing::short_run(10));
  const std::string config = folder_ / "c.toml";
  ASSERT_EQ(testing::rfmvo("info --config " + in_quotes(log_) + " >" + in_quotes(config)).exit_code, 0);
  const auto replay = testing::rfmvo("replay " + in_quotes(log_) + " --config " + in_quotes(config) + " --out " +
                                     in_quotes(folder_ / "r.lcmlog"));
  EXPECT_EQ(replay.exit_code, 0) << replay.err;
}

TEST_F(Info, ALogOfOthersIsToldToo) {
  auto writer = LogFileWriter::create(log_);
  ASSERT_TRUE(writer.ok());
  const std::vector<std::uint8_t> bytes(20, 7);
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(writer.value()->write("ROBOT", 1'000'000 + k, bytes).ok());
  ASSERT_TRUE(writer.value()->close().ok());
  const auto result = testing::rfmvo("info " + in_quotes(log_));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("ROBOT"));
  EXPECT_THAT(result.out, HasSubstr("no START"));
}

TEST_F(Info, ATruncatedLogTellsWhatItHoldsAndWhereItEnds) {
  testing::write_journal(log_, testing::one_of_each_event());
  const std::string whole = testing::read_file(log_);
  testing::write_file(folder_ / "cut.lcmlog", whole.substr(0, whole.size() - 3));
  const auto result = testing::rfmvo("info " + in_quotes(folder_ / "cut.lcmlog"));
  expect_one_line(result, "cut.lcmlog: byte ");
  EXPECT_THAT(result.out, HasSubstr("RFMVO_TAG_READ"));
}

TEST_F(Info, JsonIsOverwrittenOnlyByForce) {
  testing::write_journal(log_, testing::short_run(3));
  const std::string command = "info " + in_quotes(log_) + " --json " + in_quotes(folder_ / "info.json");
  EXPECT_EQ(testing::rfmvo(command).exit_code, 0);
  expect_one_line(testing::rfmvo(command), "info.json: is there already; --force overwrites it");
  EXPECT_EQ(testing::rfmvo(command + " --force").exit_code, 0);
}

TEST_F(Info, BadInputIsOneLine) {
  expect_one_line(testing::rfmvo("info /nowhere/x.lcmlog"), "/nowhere/x.lcmlog: no such file");
  expect_one_line(testing::rfmvo("info"), "log is required", 2);
  testing::write_file(folder_ / "text.txt", "a text that is much longer than the header of a log");
  expect_one_line(testing::rfmvo("info " + in_quotes(folder_ / "text.txt")), "text.txt: byte 0: not an LCM log");
  expect_one_line(testing::rfmvo("info --json " + in_quotes(folder_ / "text.txt")), "not an LCM log");
}

}  // namespace
}  // namespace rfmvo
