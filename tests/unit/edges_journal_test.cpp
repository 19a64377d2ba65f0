#include "edges/journal.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <lcm/lcm-cpp.hpp>

#include "edges/lcm_codec.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using testing::read_file;
using testing::TemporaryFolder;
using testing::write_file;

const std::string kPrefix = "RFMVO_";

// All events, or the error's text.
std::string read_all(const std::string& path, std::vector<Event>* events = nullptr, bool frames = true) {
  auto reader = JournalReader::open(path, kPrefix, {frames});
  if (!reader) return reader.error().text();
  while (true) {
    auto event = reader.value()->next();
    if (!event) return event.error().text();
    if (!event.value()) return "";
    if (events != nullptr) events->push_back(*event.value());
  }
}

TEST(Journal, EventsComeBackInOrderAndToTheLastBit) {
  const TemporaryFolder folder;
  const auto events = testing::one_of_each_event();
  testing::write_journal(folder / "run.lcmlog", events);
  std::vector<Event> back;
  ASSERT_EQ(read_all(folder / "run.lcmlog", &back), "");
  ASSERT_EQ(back.size(), events.size());
  for (std::size_t i = 0; i < events.size(); ++i)
    EXPECT_EQ(encode(back[i], kPrefix).data, encode(events[i], kPrefix).data);
}

TEST(Journal, FramesAreSkippedOnRequest) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "run.lcmlog", testing::one_of_each_event());
  std::vector<Event> back;
  ASSERT_EQ(read_all(folder / "run.lcmlog", &back, false), "");
  EXPECT_EQ(back.size(), testing::one_of_each_event().size() - 1);
}

TEST(Journal, LiblcmReadsWhatWeWrite) {
  const TemporaryFolder folder;
  const auto events = testing::one_of_each_event();
  testing::write_journal(folder / "run.lcmlog", events);
  lcm::LogFile log(folder / "run.lcmlog", "r");
  ASSERT_TRUE(log.good());
  for (std::size_t i = 0; i < events.size(); ++i) {
    const lcm::LogEvent* record = log.readNextEvent();
    ASSERT_NE(record, nullptr);
    EXPECT_EQ(record->eventnum, static_cast<std::int64_t>(i));
    EXPECT_EQ(record->timestamp, time_of(events[i]).us());
    EXPECT_EQ(record->channel, encode(events[i], kPrefix).channel);
  }
  EXPECT_EQ(log.readNextEvent(), nullptr);
}

TEST(Journal, WeReadWhatLiblcmWritesAndSkipForeignChannels) {
  const TemporaryFolder folder;
  const auto events = testing::one_of_each_event();
  {
    lcm::LogFile log(folder / "run.lcmlog", "w");
    lcm::LogEvent record{};
    std::string noise = "noise";
    record.channel = "OTHER";
    record.data = noise.data();
    record.datalen = static_cast<std::int32_t>(noise.size());
    log.writeEvent(&record);
    for (const Event& event : events) {
      LcmMessage message = encode(event, kPrefix);
      record.timestamp = message.utime;
      record.channel = message.channel;
      record.data = message.data.data();
      record.datalen = static_cast<std::int32_t>(message.data.size());
      log.writeEvent(&record);
    }
  }
  std::vector<Event> back;
  ASSERT_EQ(read_all(folder / "run.lcmlog", &back), "");
  EXPECT_EQ(back.size(), events.size());
}

TEST(Journal, EveryTruncationIsAnErrorThatNamesFileAndOffset) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "run.lcmlog", {Tick{DeviceTime::from_us(1)}, Tick{DeviceTime::from_us(2)}});
  const std::string whole = read_file(folder / "run.lcmlog");
  const std::size_t record = whole.size() / 2;
  const std::string cut = folder / "cut.lcmlog";
  for (std::size_t size = 1; size < whole.size(); ++size) {
    write_file(cut, whole.substr(0, size));
    const std::string offset = std::to_string(size < record ? 0 : record);
    const std::string expected = cut + ": byte " + offset + ": truncated: the record that starts here is not whole";
    EXPECT_EQ(read_all(cut), size == record ? "" : expected) << size;
  }
  write_file(cut, "");
  EXPECT_EQ(read_all(cut), cut + ": an empty file, not an LCM log");
}

TEST(Journal, AForeignFileIsAnError) {
  const TemporaryFolder folder;
  write_file(folder / "notes.txt", "this is not an LCM log, but a text");
  EXPECT_EQ(read_all(folder / "notes.txt"),
            folder / "notes.txt: byte 0: not an LCM log: no record starts here (sync word missing)");
  testing::write_journal(folder / "run.lcmlog", {Tick{DeviceTime::from_us(1)}});
  const std::string good = read_file(folder / "run.lcmlog");
  write_file(folder / "tail.lcmlog", good + "garbage behind the last record, longer than a header");
  EXPECT_EQ(read_all(folder / "tail.lcmlog"), folder / "tail.lcmlog: byte " + std::to_string(good.size()) +
                                                  ": not an LCM log: no record starts here (sync word missing)");
}

TEST(Journal, AnAbsurdLengthIsAnErrorAndAllocatesNothing) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "run.lcmlog", {Tick{DeviceTime::from_us(1)}});
  for (const std::size_t offset : {20u, 24u}) {
    std::string bytes = read_file(folder / "run.lcmlog");
    bytes[offset] = '\x7f';
    write_file(folder / "bad.lcmlog", bytes);
    EXPECT_EQ(read_all(folder / "bad.lcmlog"), folder / "bad.lcmlog: byte 0: damaged: a record's length is out of range");
  }
}

TEST(Journal, AMessageOfAnotherVersionNamesOffsetAndChannel) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "run.lcmlog", {Tick{DeviceTime::from_us(1)}});
  std::string bytes = read_file(folder / "run.lcmlog");
  bytes[28 + std::string("RFMVO_TICK").size()] ^= 1;  // the fingerprint
  write_file(folder / "bad.lcmlog", bytes);
  EXPECT_EQ(read_all(folder / "bad.lcmlog"),
            folder / "bad.lcmlog: byte 0: RFMVO_TICK: not a whole rfmvo.tick_t message of this version");
}

TEST(Journal, AMissingFileIsNamed) {
  EXPECT_EQ(read_all("/nowhere/run.lcmlog"), "/nowhere/run.lcmlog: no such file");
}

TEST(LogWriter, NothingIsLeftBehindUnlessTheLogWasClosed) {
  const TemporaryFolder folder;
  {
    auto writer = LogWriter::create(folder / "run.lcmlog", kPrefix);
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(writer.value()->write(Tick{}).ok());
    EXPECT_EQ(folder.names(), std::vector<std::string>{"run.lcmlog.tmp"});
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(LogWriter, AnOldFileStaysUntilTheNewOneIsWhole) {
  const TemporaryFolder folder;
  write_file(folder / "run.lcmlog", "old");
  auto writer = LogWriter::create(folder / "run.lcmlog", kPrefix);
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(writer.value()->write(Tick{}).ok());
  EXPECT_EQ(read_file(folder / "run.lcmlog"), "old");
  ASSERT_TRUE(writer.value()->close().ok());
  EXPECT_EQ(read_all(folder / "run.lcmlog"), "");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"run.lcmlog"});
}

TEST(LogWriter, AnUnwritablePlaceIsNamed) {
  const TemporaryFolder folder;
  const auto error = [](const std::string& path) {
    auto writer = LogWriter::create(path, kPrefix);
    return writer.ok() ? "" : writer.error().text();
  };
  EXPECT_EQ(error("/nowhere/run.lcmlog"), "/nowhere/run.lcmlog: cannot be written: No such file or directory");
  write_file(folder / "sub/x", "");
  EXPECT_EQ(error(folder / "sub"), folder / "sub: cannot be written: it is a folder, not a file");
  auto first = LogWriter::create(folder / "run.lcmlog", kPrefix);
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(error(folder / "run.lcmlog"), folder / "run.lcmlog: cannot be written: another program is writing it");
}

TEST(ResultLog, EstimatesComeBackInOrder) {
  const TemporaryFolder folder;
  auto writer = LogWriter::create(folder / "result.lcmlog", kPrefix);
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(writer.value()->write(testing::sample_start()).ok());
  const auto estimates = testing::one_of_each_estimate();
  for (const Estimate& estimate : estimates) ASSERT_TRUE(writer.value()->publish(estimate).ok());
  ASSERT_TRUE(writer.value()->close().ok());
  const auto back = read_estimates(folder / "result.lcmlog", kPrefix);
  ASSERT_TRUE(back.ok()) << back.error().text();
  ASSERT_EQ(back.value().size(), estimates.size());
  for (std::size_t i = 0; i < estimates.size(); ++i)
    EXPECT_EQ(encode(back.value()[i], kPrefix).front().data, encode(estimates[i], kPrefix).front().data);
}

}  // namespace
}  // namespace rfmvo
