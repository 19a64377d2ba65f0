// rfmvo log on a real bus, and its files.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "edges/lcm_codec.hpp"
#include "edges/log_file.hpp"
#include "host/host_command.hpp"
#include "host/real_bus.hpp"
#include "inspect/run_info.hpp"
#include "record/log_series.hpp"
#include "record/recorder.hpp"

namespace rfmvo {
namespace {

using testing::Background;
using ::testing::ElementsAre;
using testing::expect_one_line;
using ::testing::HasSubstr;
using testing::in_quotes;
using testing::TemporaryFolder;
using Json = nlohmann::json;

std::vector<LogRecord> records_of(const std::string& path) {
  std::vector<LogRecord> records;
  const auto reader = LogFileReader::open(path);
  EXPECT_TRUE(reader.ok()) << reader.error().text();
  while (reader.ok()) {
    auto next = reader.value()->next();
    EXPECT_TRUE(next.ok()) << next.error().text();
    if (!next.ok() || !next.value()) break;
    records.push_back(*next.value());
  }
  return records;
}

class LogOnBus : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::has_multicast()) GTEST_SKIP() << "this machine has no multicast";
  }
  std::unique_ptr<Background> start(const std::string& more = "") {
    auto logger =
        std::make_unique<Background>(RFMVO_COMMAND " log " + in_quotes(log_) + " --url " + in_quotes(url_) + " " + more,
                                     folder_ / "out", folder_ / "err");
    EXPECT_TRUE(logger->said("recording")) << logger->err();
    return logger;
  }
  TemporaryFolder folder_;
  std::string url_ = testing::bus_url();
  std::string log_ = folder_ / "bus.lcmlog";
};

// liblcm sends, small messages and such as need many datagrams; then at once Ctrl-C.
TEST_F(LogOnBus, HoldsEveryMessageUntilCtrlC) {
  const auto logger = start("--json " + in_quotes(folder_ / "log.json"));
  lcm::LCM bus(url_);
  ASSERT_TRUE(bus.good());
  constexpr int kMessages = 300;
  std::vector<std::vector<std::uint8_t>> sent;
  for (int k = 0; k < kMessages; ++k) {
    const std::size_t size = k % 50 == 0 ? 300'000 : 10 + static_cast<std::size_t>(k);
    std::vector<std::uint8_t> data(size, static_cast<std::uint8_t>(k));
    ASSERT_EQ(bus.publish(k % 2 == 0 ? "EVEN" : "ODD", data.data(), static_cast<unsigned>(size)), 0);
    sent.push_back(std::move(data));
    if (k % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));  // as a camera, not as a flood
  }
  ASSERT_EQ(logger->end(SIGINT), 0) << logger->err();

  const auto records = records_of(log_);
  const Json json = Json::parse(testing::read_file(folder_ / "log.json"));
  EXPECT_EQ(records.size() + json.at("lost").get<std::size_t>(), static_cast<std::size_t>(kMessages));
  EXPECT_EQ(json.at("messages"), records.size());
  EXPECT_EQ(json.at("lost"), 0) << "on a machine with a receive buffer below 2 MB this may happen";
  for (std::size_t k = 0; k < std::min(records.size(), sent.size()); ++k) EXPECT_TRUE(records[k].data == sent[k]) << k;
  EXPECT_THAT(logger->out(), HasSubstr("300 messages"));
  EXPECT_THAT(logger->out(), HasSubstr("; 0 lost"));
}

TEST_F(LogOnBus, RecordsOnlyChannelsThatMatch) {
  const auto logger = start("--channel 'RFMVO_(TAG|SCALE)'");
  lcm::LCM bus(url_);
  for (const Estimate& estimate : testing::one_of_each_estimate())
    for (const LcmMessage& m : encode(estimate, "RFMVO_"))
      bus.publish(m.channel, m.data.data(), static_cast<unsigned>(m.data.size()));
  ASSERT_EQ(logger->end(SIGTERM), 0) << logger->err();
  const auto records = records_of(log_);
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].channel, "RFMVO_TAG");
  EXPECT_EQ(records[1].channel, "RFMVO_SCALE");
}

TEST_F(LogOnBus, AnotherRecordingIsOverwrittenOnlyByForce) {
  testing::write_file(log_, "precious");
  const std::string command = "log " + in_quotes(log_) + " --url " + in_quotes(url_) + " --duration-s 0.01 ";
  expect_one_line(testing::rfmvo(command), "bus.lcmlog: is there already; --force overwrites it");
  EXPECT_EQ(testing::read_file(log_), "precious");
  EXPECT_EQ(testing::rfmvo(command + "--force").exit_code, 0);
  EXPECT_EQ(testing::read_file(log_), "");
}

TEST_F(LogOnBus, BadInputIsOneLine) {
  expect_one_line(testing::rfmvo("log"), "out is required", 2);
  expect_one_line(testing::rfmvo("log " + in_quotes(log_) + " --channel '('"), "--channel", 2);
  expect_one_line(testing::rfmvo("log " + in_quotes(log_) + " --rotate 2"), "--split-mb", 2);
  expect_one_line(testing::rfmvo("log /nowhere/x.lcmlog --url " + in_quotes(url_)),
                  "/nowhere/x.lcmlog: cannot be written");
  expect_one_line(testing::rfmvo("log " + in_quotes(log_) + " --url udpm://10.0.0.1:7667"), "not a multicast address");
  EXPECT_FALSE(std::filesystem::exists(log_));
}

BusMessage message(std::size_t bytes) { return {"A", std::vector<std::uint8_t>(bytes, 1)}; }

class Series : public ::testing::Test {
 protected:
  record::SeriesSettings settings(std::uint64_t split, std::uint64_t keep = 0) {
    record::SeriesSettings s;
    s.path = folder_ / "run.lcmlog";
    s.split_bytes = split;
    s.keep_files = keep;
    return s;
  }
  TemporaryFolder folder_;
};

TEST_F(Series, SplitsAtTheSizeAndLosesNothing) {
  auto series = record::LogSeries::create(settings(1000));
  ASSERT_TRUE(series.ok()) << series.error().text();
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(series.value()->write(message(271), k, 0).ok());  // 300 with header, channel
  ASSERT_TRUE(series.value()->close().ok());
  EXPECT_THAT(folder_.names(),
              ElementsAre("run-00001.lcmlog", "run-00002.lcmlog", "run-00003.lcmlog", "run-00004.lcmlog"));
  std::int64_t expected = 0;
  for (const std::string& name : folder_.names()) {
    EXPECT_LE(std::filesystem::file_size(folder_ / name), 1000u);
    for (const LogRecord& record : records_of(folder_ / name)) EXPECT_EQ(record.utime, expected++);
  }
  EXPECT_EQ(expected, 10);
}

TEST_F(Series, RotationKeepsTheNewest) {
  auto series = record::LogSeries::create(settings(1000, 2));
  ASSERT_TRUE(series.ok());
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(series.value()->write(message(271), k, 0).ok());
  ASSERT_TRUE(series.value()->close().ok());
  EXPECT_THAT(folder_.names(), ElementsAre("run-00003.lcmlog", "run-00004.lcmlog"));
}

TEST_F(Series, ADiskThatIsTooFullEndsTheRecordingAndKeepsIt) {
  auto s = settings(0);
  s.spare_disk_bytes = std::filesystem::space(folder_ / "").available;  // at once, or as soon as something is written
  auto series = record::LogSeries::create(s);
  ASSERT_TRUE(series.ok());
  Status written = Done{};
  std::size_t count = 0;
  for (; written && count < 100; ++count) written = series.value()->write(message(1 << 20), 0, 0);
  ASSERT_FALSE(written.ok());
  EXPECT_THAT(written.error().text(), HasSubstr("--disk-quota-mb"));
  EXPECT_EQ(records_of(folder_ / "run.lcmlog").size(), count - 1);
}

TEST_F(Series, AFullDiskKeepsWholeRecords) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  auto s = settings(0);
  std::filesystem::create_symlink("/dev/full", s.path);
  s.overwrite = true;
  auto series = record::LogSeries::create(s);
  ASSERT_TRUE(series.ok());
  Status written = series.value()->write(message(1 << 20), 0, 0);
  if (written) written = series.value()->flush();
  ASSERT_FALSE(written.ok());
  EXPECT_THAT(written.error().text(), HasSubstr("No space left on device"));
}

TEST_F(Series, EventNumbersTellWhatWasLost) {
  auto series = record::LogSeries::create(settings(0));
  ASSERT_TRUE(series.ok());
  for (const std::uint64_t lost : {0u, 0u, 3u, 0u, 4u}) ASSERT_TRUE(series.value()->write(message(1), 0, lost).ok());
  ASSERT_TRUE(series.value()->close().ok());
  const auto info = inspect::read_run_info(folder_ / "run.lcmlog", "RFMVO_");
  ASSERT_TRUE(info.ok());
  EXPECT_EQ(info.value().lost_by_recorder, 7);
}

TEST_F(Series, AnEarlierSeriesIsOverwrittenOnlyByForceAndThenWhole) {
  for (const char* name : {"run-00001.lcmlog", "run-00009.lcmlog", "run-old.lcmlog"})
    testing::write_file(folder_ / name, "x");
  auto s = settings(1000);
  const auto refused = record::LogSeries::create(s);
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().text(), HasSubstr("--force"));
  s.overwrite = true;
  ASSERT_TRUE(record::LogSeries::create(s).ok());
  EXPECT_THAT(folder_.names(), ElementsAre("run-00001.lcmlog", "run-old.lcmlog"));
}

// A bus on which somebody talks without end.
class EndlessBus : public BusListener {
 public:
  explicit EndlessBus(std::size_t bytes) : bytes_(bytes) {}
  Result<std::optional<BusMessage>> next(Duration) override { return std::optional(message(bytes_)); }
  [[nodiscard]] BusLoss loss() const override { return {}; }

 private:
  std::size_t bytes_;
};

TEST_F(Series, ARecordingEndsAlsoWhileOthersTalkOn) {
  EndlessBus bus(100);
  auto series = record::LogSeries::create(settings(0));
  ASSERT_TRUE(series.ok());
  record::RecorderFigures figures;
  const auto recorded = record::record(
      bus, *series.value(), {}, [&] { return figures.messages > 1000; }, [](const record::RecorderFigures&) {},
      figures);
  EXPECT_TRUE(recorded.ok());
  EXPECT_EQ(records_of(folder_ / "run.lcmlog").size(), figures.messages);
}

TEST_F(Series, AFullDiskEndsTheRecordingAlsoWhileOthersTalkOn) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  EndlessBus bus(1 << 20);
  auto s = settings(0);
  std::filesystem::create_symlink("/dev/full", s.path);
  s.overwrite = true;
  auto series = record::LogSeries::create(s);
  ASSERT_TRUE(series.ok());
  record::RecorderFigures figures;
  const auto recorded = record::record(
      bus, *series.value(), {}, [] { return false; }, [](const record::RecorderFigures&) {}, figures);
  ASSERT_FALSE(recorded.ok());
  EXPECT_THAT(recorded.error().text(), HasSubstr("No space left on device"));
}

}  // namespace
}  // namespace rfmvo
