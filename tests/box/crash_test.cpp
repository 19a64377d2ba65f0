// kill -9 at random moments while reads and frames come: every journal opens, little is lost, and its replay is what
// was published. RFMVO_CRASHES says how often (make crash-test: 200).
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <thread>

#include "edges/device_clock.hpp"
#include "edges/journal.hpp"
#include "edges/lcm_codec.hpp"
#include "edges/log_file.hpp"
#include "edges/recorder/segment_file.hpp"
#include "support/reader_bench.hpp"
#include "support/running_daemon.hpp"

namespace rfmvo {
namespace {

namespace fs = std::filesystem;
using testing::RunningDaemon;
using testing::TemporaryFolder;
using testing::write_file;

const std::string kPrefix = LcmConfig{}.prefix;

int crashes() {
  const char* text = std::getenv("RFMVO_CRASHES");
  return text != nullptr ? std::atoi(text) : 20;
}

// A wall that passes by: 96 x 64 px at 30 Hz, for longer than any run lives.
void write_images(const TemporaryFolder& folder) {
  constexpr int kFrames = 120;
  cv::Mat wall(64, 96 + 2 * kFrames, CV_8UC1);
  cv::theRNG().state = 5;
  cv::randu(wall, 0, 255);
  cv::GaussianBlur(wall, wall, {5, 5}, 1.5);
  std::string times;
  write_file(folder / "run/images/0.png", "");
  for (int k = 0; k < kFrames; ++k) {
    const std::string name = "images/" + std::to_string(k) + ".png";
    cv::imwrite(folder / "run/" + name, wall(cv::Rect(2 * k, 0, 96, 64)));
    times += std::to_string(k / 30.0) + " " + name + "\n";
  }
  write_file(folder / "run/times.txt", times);
  write_file(folder / "run/calib.txt", "80 80 48 32 96 64 none\n");
}

// The whole records of a log that nobody closed.
std::vector<LogRecord> whole_records(const std::string& path) {
  std::vector<LogRecord> records;
  auto file = LogFileReader::open(path);
  if (!file) return records;
  for (auto next = file.value()->next(); next.ok() && next.value(); next = file.value()->next())
    records.push_back(*std::move(next).value());
  return records;
}

std::uintmax_t bytes_in(const std::string& folder) {
  std::uintmax_t bytes = 0;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored))
    bytes += fs::file_size(entry->path(), ignored);
  return bytes;
}

struct Crash : ::testing::Test {
  Crash() {
    write_images(folder);
    reader_sim::ServerSettings settings;
    settings.port = 0;
    auto made = reader_sim::ReaderServer::create(settings, testing::sample_model(10'000'000, 0.002), device_clock());
    EXPECT_TRUE(made.ok());
    server = std::move(made).value();
    serving = std::thread([this] {
      while (!stop) server->poll(Duration{2'000'000});
    });
    write_file(folder / "box.toml", "[camera]\nsource = \"images:" + (folder / "run") +
                                        "\"\n[lcm]\nurl = \"memq://\"\n" +
                                        "[journal]\nsegment_mb = 1\n[estimator]\npublish_interval_s = 0.2\n" +
                                        "[reader]\naddress = \"127.0.0.1\"\nport = " + std::to_string(server->port()) +
                                        "\nantennas = \"1,2\"\n");
  }
  ~Crash() override {
    stop = true;
    serving.join();
  }

  TemporaryFolder folder;
  std::unique_ptr<reader_sim::ReaderServer> server;
  std::atomic<bool> stop{false};
  std::thread serving;
};

TEST_F(Crash, EveryJournalOpensAndReplaysToWhatWasPublished) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uintmax_t> anywhere(1, 400'000);
  std::size_t compared = 0, records = 0;
  double longest_loss_s = 0.0, longest_age_s = 0.0;
  for (int k = 0; k < crashes(); ++k) {
    SCOPED_TRACE(k);
    const std::string logs = folder / ("logs" + std::to_string(k)), result = folder / "result.lcmlog";
    fs::remove(result + ".tmp");
    DeviceTime killed{};
    {
      RunningDaemon daemon(RFMVO_DAEMON, {"--config", folder / "box.toml", "--journal", logs, "--result", result},
                           folder / "log");
      const std::uintmax_t moment = anywhere(random);
      while (bytes_in(logs) < moment && daemon.is_running()) (void)::usleep(200);
      ASSERT_TRUE(daemon.is_running()) << daemon.log();
      daemon.signal(SIGKILL);
      killed = device_clock()();
      ASSERT_EQ(daemon.wait(), 1000 + SIGKILL);
    }
    const auto published = whole_records(result + ".tmp");
    ASSERT_EQ(recover_segments(logs).size(), 1u) << "one segment was being written";
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(logs)) names.push_back(entry.path().string());
    const std::string first = *std::min_element(names.begin(), names.end(), [](const auto& a, const auto& b) {
      return a.size() < b.size();  // the first segment has no number
    });
    auto journal = JournalReader::open(first, kPrefix, {});
    ASSERT_TRUE(journal.ok()) << journal.error().text();
    Pipeline pipeline;
    std::vector<LcmMessage> replayed;
    DeviceTime last{};
    while (true) {
      const auto event = journal.value()->next();
      ASSERT_TRUE(event.ok()) << event.error().text();
      if (!event.value()) break;
      ++records;
      last = std::max(last, time_of(*event.value()));
      for (const Estimate& estimate : pipeline.on(*event.value()))
        for (LcmMessage& message : encode(estimate, kPrefix)) replayed.push_back(std::move(message));
    }
    // The result begins with the Start.
    for (std::size_t i = 1; i < published.size() && i <= replayed.size(); ++i) {
      ASSERT_EQ(published[i].channel, replayed[i - 1].channel) << i;
      ASSERT_EQ(published[i].data, replayed[i - 1].data) << published[i].channel;
      ++compared;
    }
    for (const LogRecord& record : published)
      longest_loss_s = std::max(longest_loss_s, (DeviceTime::from_us(record.utime) - last).seconds());
    EXPECT_LE(longest_loss_s, 0.1) << "published, but not in the journal";
    longest_age_s = std::max(longest_age_s, (killed - last).seconds());
    fs::remove_all(logs);
  }
  RecordProperty("crashes", crashes());
  std::printf(
      "%d crashes, %zu events in journals, %zu messages equal; published but not in the journal: at most %.1f ms; "
      "newest "
      "event at most %.1f ms before the end\n",
      crashes(), records, compared, 1e3 * longest_loss_s, 1e3 * longest_age_s);
  EXPECT_GT(compared, static_cast<std::size_t>(crashes()));
}

}  // namespace
}  // namespace rfmvo
