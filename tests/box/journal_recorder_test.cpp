// The journal of a box: what waits, what is dropped, what a full or slow disk and a sudden end leave behind.
#include "edges/recorder/journal_recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <mutex>

#include "edges/journal.hpp"
#include "edges/lcm_codec.hpp"
#include "edges/recorder/segment_reader.hpp"
#include "rfmvo/journal_gap_t.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using ::testing::ElementsAre;
using testing::TemporaryFolder;
using ::testing::UnorderedElementsAre;

const std::string kPrefix = "RFMVO_";
constexpr std::int64_t kMs = 1'000'000;

Event frame_at(std::int64_t us, std::size_t bytes = 1000) {
  Frame frame;
  frame.time = DeviceTime::from_us(us);
  frame.sequence = us;
  frame.width_px = static_cast<int>(bytes);
  frame.height_px = 1;
  frame.grey = std::make_shared<const std::vector<std::uint8_t>>(bytes);
  return frame;
}

Event tick_at(std::int64_t us) { return Tick{DeviceTime::from_us(us)}; }

// What a journal holds, as text: "F3" a frame at 3 us, "T4" a tick, "S" a Start, "gap 2+0".
std::vector<std::string> contents(const std::string& path, std::string* error = nullptr) {
  std::vector<std::string> all;
  auto reader = SegmentReader::open(path);
  if (!reader) return {reader.error().text()};
  while (true) {
    auto record = reader.value()->next();
    if (!record && error != nullptr) *error = record.error().text();
    if (!record || !record.value()) return all;
    const std::string name = record.value()->channel.substr(kPrefix.size());
    if (name == "JOURNAL_GAP") {
      journal_gap_t gap;
      EXPECT_GT(gap.decode(record.value()->data.data(), 0, static_cast<int>(record.value()->data.size())), 0);
      all.push_back("gap " + std::to_string(gap.frames) + "+" + std::to_string(gap.others));
    } else {
      all.push_back(name == "START" ? "S" : name.substr(0, 1) + std::to_string(record.value()->utime));
    }
  }
}

// A disk that can be told to wait, to be full, to be well.
struct Disk {
  std::mutex mutex;
  std::condition_variable changed;
  bool stalled = false, waiting = false, full = false;
  std::vector<std::vector<std::uint8_t>> records;
  int syncs = 0;
  bool closed = false;

  void stall(bool on) {
    const std::lock_guard lock(mutex);
    stalled = on;
    changed.notify_all();
  }
  void wait_for_records(std::size_t count) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return records.size() >= count; });
  }
  // Until the writing thread hangs in it.
  void wait_until_reached() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return waiting; });
  }
};

class FakeStore : public JournalStore {
 public:
  explicit FakeStore(Disk& disk) : disk_(disk) {}
  [[nodiscard]] Status begin(std::vector<std::uint8_t> preamble) override { return append(preamble); }
  [[nodiscard]] Status append(std::span<const std::uint8_t> records) override {
    std::unique_lock lock(disk_.mutex);
    disk_.waiting = true;
    disk_.changed.notify_all();
    disk_.changed.wait(lock, [this] { return !disk_.stalled; });
    disk_.waiting = false;
    if (disk_.full) return Error{ErrorCode::kUnwritable, "cannot be written: no space", "disk"};
    disk_.records.emplace_back(records.begin(), records.end());
    disk_.changed.notify_all();
    return Done{};
  }
  [[nodiscard]] Status sync() override {
    const std::lock_guard lock(disk_.mutex);
    ++disk_.syncs;
    return Done{};
  }
  [[nodiscard]] Status close() override {
    disk_.closed = true;
    return Done{};
  }

 private:
  Disk& disk_;
};

std::vector<std::string> contents_of(const Disk& disk, const TemporaryFolder& folder) {
  std::string bytes;
  for (const auto& record : disk.records) bytes.append(record.begin(), record.end());
  testing::write_file(folder / "disk.lcmlog", bytes);
  return contents(folder / "disk.lcmlog");
}

JournalRecorder::Settings settings_of(std::int64_t queue_bytes, bool may_drop = true) {
  return {kPrefix, queue_bytes, Duration{1000 * 1000 * kMs}, may_drop};
}

TEST(JournalQueue, FramesMakeRoomTheOldestFirstAndReadsStay) {
  JournalQueue queue(4100);  // two frames and two ticks
  queue.push(frame_at(1));
  queue.push(tick_at(2));
  queue.push(frame_at(3));
  queue.push(tick_at(4));
  queue.push(frame_at(5));  // 1 goes
  queue.push(frame_at(6));  // 3 goes
  EXPECT_LE(queue.bytes(), 4100);
  EXPECT_EQ(queue.lost().frames, 2u);
  EXPECT_EQ(queue.lost().others, 0u);
  std::vector<std::string> order;
  while (auto item = queue.pop())
    order.push_back(std::to_string(time_of(item->event).us()) + (item->lost_before.any() ? " after a gap" : ""));
  EXPECT_THAT(order, ElementsAre("2 after a gap", "4 after a gap", "5", "6"));
  EXPECT_EQ(queue.bytes(), 0);
}

TEST(JournalQueue, NeverGrowsBeyondItsBoundAndCountsEverything) {
  JournalQueue queue(5000);
  std::uint64_t pushed = 0, popped = 0, told = 0;
  for (std::int64_t k = 0; k < 1000; ++k) {
    queue.push(k % 3 == 0 ? frame_at(k, 100 + static_cast<std::size_t>(k) % 4000) : tick_at(k));
    ++pushed;
    EXPECT_LE(queue.bytes(), 5000);
    if (k % 7 == 0)
      if (auto item = queue.pop()) {
        ++popped;
        told += item->lost_before.frames + item->lost_before.others;
      }
  }
  while (auto item = queue.pop()) {
    ++popped;
    told += item->lost_before.frames + item->lost_before.others;
  }
  const JournalLoss tail = queue.take_tail_loss();
  EXPECT_EQ(told + tail.frames + tail.others, queue.lost().frames + queue.lost().others);
  EXPECT_EQ(popped + queue.lost().frames + queue.lost().others, pushed);
  EXPECT_GT(queue.lost().others, 0u);
}

TEST(JournalRecorder, WritesEverythingInOrder) {
  const TemporaryFolder folder;
  Disk disk;
  JournalRecorder recorder(std::make_unique<FakeStore>(disk), settings_of(1'000'000));
  ASSERT_TRUE(recorder.write(testing::sample_start()).ok());
  ASSERT_TRUE(recorder.write(frame_at(1)).ok());
  ASSERT_TRUE(recorder.write(tick_at(2)).ok());
  ASSERT_TRUE(recorder.close().ok());
  EXPECT_TRUE(disk.closed);
  EXPECT_THAT(contents_of(disk, folder), ElementsAre("S", "F1", "T2"));
  EXPECT_FALSE(recorder.counters().lost.any());
}

// The estimator's thread calls write(); it returns while the disk hangs.
TEST(JournalRecorder, AStalledDiskStopsNobodyAndEveryLossIsSaidWhereItIs) {
  const TemporaryFolder folder;
  Disk disk;
  JournalRecorder recorder(std::make_unique<FakeStore>(disk), settings_of(4000));
  ASSERT_TRUE(recorder.write(testing::sample_start()).ok());
  disk.wait_for_records(1);
  disk.stall(true);
  ASSERT_TRUE(recorder.write(tick_at(1)).ok());
  disk.wait_until_reached();
  for (std::int64_t us = 2; us <= 7; ++us) ASSERT_TRUE(recorder.write(frame_at(us)).ok());
  ASSERT_TRUE(recorder.write(tick_at(8)).ok());
  EXPECT_GT(recorder.counters().lost.frames, 0u);
  EXPECT_EQ(recorder.counters().lost.others, 0u);
  disk.stall(false);
  ASSERT_TRUE(recorder.close().ok());
  EXPECT_THAT(contents_of(disk, folder), ElementsAre("S", "T1", "gap 4+0", "F6", "F7", "T8"));
}

TEST(JournalRecorder, AFullDiskLosesWhatItMustAndSaysSoOnceThereIsRoom) {
  const TemporaryFolder folder;
  Disk disk;
  JournalRecorder recorder(std::make_unique<FakeStore>(disk), settings_of(1'000'000));
  ASSERT_TRUE(recorder.write(testing::sample_start()).ok());
  ASSERT_TRUE(recorder.write(tick_at(1)).ok());
  disk.wait_for_records(2);
  {
    const std::lock_guard lock(disk.mutex);
    disk.full = true;
  }
  ASSERT_TRUE(recorder.write(frame_at(2)).ok());
  ASSERT_TRUE(recorder.write(tick_at(3)).ok());
  while (recorder.counters().lost.others == 0) std::this_thread::yield();
  EXPECT_EQ(recorder.counters().last_error, "disk: cannot be written: no space");
  {
    const std::lock_guard lock(disk.mutex);
    disk.full = false;
  }
  ASSERT_TRUE(recorder.write(tick_at(4)).ok());
  ASSERT_TRUE(recorder.close().ok());
  EXPECT_THAT(contents_of(disk, folder), ElementsAre("S", "T1", "gap 1+1", "T4"));
  EXPECT_EQ(recorder.counters().lost.frames, 1u);
}

TEST(JournalRecorder, WaitsForTheDiskIfItsSourceCanWait) {
  const TemporaryFolder folder;
  Disk disk;
  JournalRecorder recorder(std::make_unique<FakeStore>(disk), settings_of(3000, false));
  ASSERT_TRUE(recorder.write(testing::sample_start()).ok());
  std::vector<std::string> expected{"S"};
  for (std::int64_t us = 1; us <= 200; ++us) {
    ASSERT_TRUE(recorder.write(frame_at(us)).ok());
    expected.push_back("F" + std::to_string(us));
  }
  ASSERT_TRUE(recorder.close().ok());
  EXPECT_EQ(contents_of(disk, folder), expected);
}

TEST(JournalRecorder, SyncsAsOftenAsItWasTold) {
  Disk disk;
  JournalRecorder::Settings settings = settings_of(1'000'000);
  settings.flush = Duration{0};
  JournalRecorder recorder(std::make_unique<FakeStore>(disk), settings);
  for (std::int64_t us = 1; us <= 20; ++us) ASSERT_TRUE(recorder.write(tick_at(us)).ok());
  ASSERT_TRUE(recorder.close().ok());
  EXPECT_EQ(disk.syncs, 20) << "with no time allowed, after every record";
}

TEST(JournalRecorder, SyncsWhenNothingMoreComes) {
  Disk disk;
  JournalRecorder::Settings settings = settings_of(1'000'000);
  settings.flush = Duration{kMs};
  JournalRecorder recorder(std::make_unique<FakeStore>(disk), settings);
  ASSERT_TRUE(recorder.write(tick_at(1)).ok());
  const auto syncs = [&] {
    const std::lock_guard lock(disk.mutex);
    return disk.syncs;
  };
  while (syncs() == 0) std::this_thread::yield();  // no event comes any more; the sync does
}

struct SegmentsTest : ::testing::Test {
  std::unique_ptr<SegmentedStore> store(std::int64_t segment_bytes, std::int64_t quota_bytes = 0,
                                        const std::string& run = "run") {
    auto created = SegmentedStore::create(folder / run, {segment_bytes, quota_bytes});
    EXPECT_TRUE(created.ok()) << created.error().text();
    return std::move(created).value();
  }
  std::vector<std::uint8_t> record(std::int64_t us, const std::string& channel = "TICK", std::size_t bytes = 60) {
    std::vector<std::uint8_t> record;
    append_log_record(record, us, us, kPrefix + channel, std::vector<std::uint8_t>(bytes));
    return record;
  }
  void fill(SegmentedStore& store, std::int64_t from, std::int64_t to) {
    for (std::int64_t us = from; us <= to; ++us) ASSERT_TRUE(store.append(record(us)).ok());
  }
  TemporaryFolder folder;
};

TEST_F(SegmentsTest, FollowEachOtherAndReadAsOne) {
  auto writing = store(500);
  ASSERT_TRUE(writing->begin(record(0, "START")).ok());
  fill(*writing, 1, 20);
  EXPECT_THAT(folder.names(), ::testing::Contains("run.0002.lcmlog"));
  std::vector<std::string> expected{"S"};
  for (int us = 1; us <= 20; ++us) expected.push_back("T" + std::to_string(us));
  EXPECT_EQ(contents(folder / "run.lcmlog"), expected) << "while it is being written";
  ASSERT_TRUE(writing->close().ok());
  EXPECT_EQ(contents(folder / "run.lcmlog"), expected);
  EXPECT_THAT(folder.names(), ::testing::Not(::testing::Contains(::testing::HasSubstr(".tmp"))));
  const auto late = contents(folder / "run.0003.lcmlog");
  ASSERT_GT(late.size(), 2u);
  EXPECT_EQ(late[0], "S") << "each segment can be read when the older ones have gone";
  EXPECT_EQ(late.back(), "T20");
}

TEST_F(SegmentsTest, TheOldestGoWhenTheQuotaIsFull) {
  {
    auto earlier = store(500, 0, "20200101");
    ASSERT_TRUE(earlier->begin(record(0, "START")).ok());
    fill(*earlier, 1, 8);
    ASSERT_TRUE(earlier->close().ok());
  }
  testing::write_file(folder / "notes.txt", std::string(5000, 'x'));
  // A run of a box without a clock: its name says 1970, and yet it is the youngest.
  auto writing = store(500, 1500, "19700101");
  ASSERT_TRUE(writing->begin(record(0, "START")).ok());
  for (std::int64_t us = 1; us <= 60; ++us) {
    ASSERT_TRUE(writing->append(record(us)).ok());
    std::int64_t bytes = 0;
    for (const std::string& name : folder.names())
      if (name.find("lcmlog") != std::string::npos)
        bytes += static_cast<std::int64_t>(std::filesystem::file_size(folder / name));
    EXPECT_LE(bytes, us < 4 ? 2500 : 1500);
  }
  ASSERT_TRUE(writing->close().ok());
  const auto names = folder.names();
  EXPECT_THAT(names, ::testing::Contains("notes.txt")) << "what is not ours stays";
  EXPECT_THAT(names, ::testing::Not(::testing::Contains(::testing::StartsWith("20200101"))));
  EXPECT_THAT(names, ::testing::Not(::testing::Contains("19700101.lcmlog")));
  EXPECT_EQ(contents(folder / names[names.size() - 2]).back(), "T60");
}

TEST_F(SegmentsTest, AnUnfinishedSegmentIsRecoveredUpToItsLastWholeRecordAtEveryLength) {
  std::vector<std::uint8_t> bytes;
  std::vector<std::size_t> ends{0};
  for (std::int64_t us = 1; us <= 4; ++us) {
    const auto one = record(us, us == 1 ? "START" : "TICK", 10);
    bytes.insert(bytes.end(), one.begin(), one.end());
    ends.push_back(bytes.size());
  }
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const TemporaryFolder own;
    testing::write_file(own / "run.lcmlog.tmp",
                        std::string(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
    const auto whole = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), size) - ends.begin() - 1);
    if (whole > 0) {
      EXPECT_EQ(contents(own / "run.lcmlog").size(), whole) << "already as it lies there";
    }
    const auto recovered = recover_segments(own / "");
    ASSERT_EQ(recovered.size(), 1u) << size;
    EXPECT_EQ(recovered[0].records, static_cast<std::int64_t>(whole));
    EXPECT_EQ(recovered[0].bytes_cut, static_cast<std::int64_t>(size - ends[whole]));
    if (whole == 0) {
      EXPECT_TRUE(own.names().empty());
    } else {
      std::string error;
      EXPECT_THAT(own.names(), ElementsAre("run.lcmlog"));
      EXPECT_EQ(contents(own / "run.lcmlog", &error).size(), whole);
      EXPECT_EQ(error, "");
    }
  }
}

TEST_F(SegmentsTest, ZerosBehindTheLastRecordAreCutOff) {
  const auto one = record(1);
  testing::write_file(folder / "run.0007.lcmlog.tmp", std::string(one.begin(), one.end()) + std::string(4096, '\0'));
  const auto recovered = recover_segments(folder / "");
  ASSERT_EQ(recovered.size(), 1u);
  EXPECT_EQ(recovered[0].bytes_cut, 4096);
  EXPECT_THAT(contents(folder / "run.0007.lcmlog"), ElementsAre("T1"));
}

TEST_F(SegmentsTest, WhatAnotherProgramWritesIsLeftAlone) {
  auto writing = store(500);
  ASSERT_TRUE(writing->append(record(1)).ok());
  EXPECT_TRUE(recover_segments(folder / "").empty());
  EXPECT_THAT(folder.names(), ElementsAre("run.lcmlog.tmp"));
}

// A small file system would need root: a limit on the size of files is refused in the same place (EFBIG).
TEST_F(SegmentsTest, ARecordThatDoesNotFitIsTakenBackWhole) {
  auto file = SegmentFile::create({folder / "run", 1, true});
  ASSERT_TRUE(file.ok());
  SegmentFile segment = std::move(file).value();
  ASSERT_TRUE(segment.append(record(1)).ok());
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{static_cast<rlim_t>(segment.bytes()) + 40, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_FALSE(segment.append(record(2)).ok());
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  (void)::signal(SIGXFSZ, handler);
  ASSERT_TRUE(segment.append(record(3)).ok()) << "there is room again";
  ASSERT_TRUE(segment.finish().ok());
  std::string error;
  EXPECT_THAT(contents(folder / "run.lcmlog", &error), ElementsAre("T1", "T3"));
  EXPECT_EQ(error, "");
}

TEST(SegmentName, GoesThereAndBack) {
  for (const std::string path : {"/a/run.lcmlog", "/a/run.0002.lcmlog", "/a/run.12345.lcmlog.tmp", "x.lcmlog.tmp"}) {
    const auto name = segment_name(path);
    ASSERT_TRUE(name) << path;
    EXPECT_EQ(name->path_on_disk(), path);
  }
  EXPECT_EQ(segment_name("/a/run.0002.lcmlog")->number, 2);
  EXPECT_EQ(segment_name("/a/my.run.lcmlog")->run, "/a/my.run");
  EXPECT_EQ(segment_name("/a/run.0001.lcmlog"), std::nullopt) << "the first one has no number";
  for (const std::string path : {"/a/run", "", ".lcmlog", "/a/.lcmlog", "/a/run.lcmlog.bak"})
    EXPECT_EQ(segment_name(path), std::nullopt) << path;
}

}  // namespace
}  // namespace rfmvo
