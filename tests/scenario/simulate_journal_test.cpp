// A simulated run through the journal: what the estimator would get in a replay is what was simulated.
#include <gtest/gtest.h>

#include <filesystem>

#include "edges/journal.hpp"
#include "edges/lcm_codec.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "T_";

struct Replayed {
  std::vector<std::vector<std::uint8_t>> simulated, replayed;
};

Replayed through_journal(const simulate::Options& options, const std::string& path) {
  Replayed r;
  auto log = LogWriter::create(path, kPrefix);
  EXPECT_TRUE(log.ok());
  const auto writer = std::move(log).value();
  EXPECT_TRUE(simulate::simulate(options, [&](const Event& event) {
                r.simulated.push_back(encode(event, kPrefix).data);
                return writer->write(event);
              }).ok());
  EXPECT_TRUE(writer->close().ok());
  auto opened = JournalReader::open(path, kPrefix, {});
  EXPECT_TRUE(opened.ok());
  const auto reader = std::move(opened).value();
  for (;;) {
    auto event = reader->next();
    EXPECT_TRUE(event.ok());
    if (!event.ok() || !event.value()) return r;
    r.replayed.push_back(encode(*event.value(), kPrefix).data);
  }
}

TEST(SimulatedJournal, ReplaysEveryEventAsItWas) {
  const std::string path = (fs::path(testing::TempDir()) / "rfmvo_s3.lcmlog").string();
  simulate::Options options;
  options.scene = "S3";
  const Replayed r = through_journal(options, path);
  EXPECT_GT(r.simulated.size(), 800U);
  EXPECT_EQ(r.simulated, r.replayed);
  fs::remove(path);
}

TEST(SimulatedJournal, OfRealImagesReplaysEveryEventAsItWas) {
  const std::string images = std::string(RFMVO_TEST_DATA) + "/davis-slider-depth";
  if (!fs::exists(images)) GTEST_SKIP() << images << " is not there";
  const std::string path = (fs::path(testing::TempDir()) / "rfmvo_images.lcmlog").string();
  simulate::Options options;
  options.images_dir = images;
  const Replayed r = through_journal(options, path);
  EXPECT_GT(r.simulated.size(), 200U);
  EXPECT_EQ(r.simulated, r.replayed);
  fs::remove(path);
}

}  // namespace
}  // namespace rfmvo
