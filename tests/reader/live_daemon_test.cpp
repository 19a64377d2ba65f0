// rfmvod, live: a reader on a real socket, images at their own pace, and a journal of both.
#include <gtest/gtest.h>

#include <atomic>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "edges/journal.hpp"
#include "reader_sim/reader_server.hpp"
#include "support/reader_bench.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using testing::run_command;
using testing::TemporaryFolder;
using testing::write_file;

constexpr int kFrames = 12;
constexpr double kFramePeriod_s = 0.1;

void write_images(const TemporaryFolder& folder) {
  std::string times;
  write_file(folder / "run/images/0.png", "");
  for (int k = 0; k < kFrames; ++k) {
    const std::string name = "images/" + std::to_string(k) + ".png";
    cv::imwrite(folder / "run/" + name, cv::Mat(6, 8, CV_8UC1, cv::Scalar(k)));
    times += std::to_string(5.0 + k * kFramePeriod_s) + " " + name + "\n";
  }
  write_file(folder / "run/times.txt", times);
  write_file(folder / "run/calib.txt", "10 10 4 3 8 6 none\n");
}

TEST(LiveDaemon, JournalsReadsAndFramesInOneTime) {
  const TemporaryFolder folder;
  write_images(folder);
  const auto clock = device_clock();
  reader_sim::ServerSettings settings;
  settings.port = 0;
  auto model = testing::sample_model(100'000, 0.01);
  model.troubles.year_2000 = true;
  auto server = reader_sim::ReaderServer::create(settings, std::move(model), clock);
  ASSERT_TRUE(server.ok());
  std::atomic<bool> stop{false};
  std::thread serving([&] {
    while (!stop) server.value()->poll(Duration{5'000'000});
  });
  write_file(folder / "box.toml", "[camera]\nsource = \"images:" + (folder / "run") + "\"\n[lcm]\nurl = \"memq://\"\n" +
                                      "[reader]\naddress = \"127.0.0.1\"\nport = " +
                                      std::to_string(server.value()->port()) + "\nantennas = \"1,2\"\n");
  const auto ran = run_command(RFMVO_DAEMON " --config '" + (folder / "box.toml") + "' --journal '" +
                               (folder / "logs") + "' --result '" + (folder / "result.lcmlog") + "'");
  stop = true;
  serving.join();
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_FALSE(server.value()->reader().active()) << "left in order";

  const auto journals = std::filesystem::directory_iterator(folder / "logs");
  auto reader = JournalReader::open(journals->path().string(), LcmConfig{}.prefix, {true});
  ASSERT_TRUE(reader.ok()) << reader.error().text();
  std::vector<Event> events;
  for (auto next = reader.value()->next(); next.ok() && next.value(); next = reader.value()->next())
    events.push_back(*next.value());
  ASSERT_FALSE(events.empty());
  EXPECT_TRUE(std::holds_alternative<Start>(events.front()));
  std::vector<TagRead> reads;
  std::vector<DeviceTime> frames;
  ReaderStatus status;
  for (const Event& event : events) {
    if (const auto* read = std::get_if<TagRead>(&event)) reads.push_back(*read);
    if (const auto* frame = std::get_if<Frame>(&event)) frames.push_back(frame->time);
    if (const auto* s = std::get_if<ReaderStatus>(&event)) status = *s;
    EXPECT_FALSE(std::holds_alternative<Fault>(event)) << std::get<Fault>(event).text;
  }
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFrames));
  EXPECT_NEAR((frames.back() - frames.front()).seconds(), (kFrames - 1) * kFramePeriod_s, 1e-5);
  // 100 reads/s for 1.1 s and the last half second, less the time to connect; a busy machine may need a while.
  EXPECT_GT(reads.size(), 40u);
  EXPECT_TRUE(status.clock_known);
  EXPECT_GT(status.clock_offset_s, 8e8) << "the reader believes in the year 2000";
  // Reads lie among the frames: the two clocks were matched.
  for (const TagRead& read : reads) {
    EXPECT_GT((read.time - frames.front()).seconds(), -0.1);
    EXPECT_LT((read.time - frames.back()).seconds(), 1.0);
  }
  // Every read is the reader's, in its order, none twice.
  for (std::size_t k = 1; k < reads.size(); ++k)
    EXPECT_EQ((reads[k].reader_time - reads[k - 1].reader_time).ns, 10'000'000);
}

TEST(LiveDaemon, RefusesAReaderBesideAJournal) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "run.lcmlog", testing::short_run(3));
  write_file(folder / "box.toml",
             "[camera]\nsource = \"journal:" + (folder / "run.lcmlog") + "\"\n[reader]\naddress = \"127.0.0.1\"\n");
  const auto ran = run_command(RFMVO_DAEMON " --config '" + (folder / "box.toml") + "'");
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_EQ(ran.err, "rfmvod: camera.source: a journal has its own reads; reader.address must be empty\n");
}

}  // namespace
}  // namespace rfmvo
