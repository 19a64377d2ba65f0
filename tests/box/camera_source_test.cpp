// A camera's troubles, on simulated time: what becomes a frame, what a fault, and when it is started anew.
#include "edges/camera/camera_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

namespace rfmvo {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;

// What a camera does at each look. Time passes only here and in pause().
struct Step {
  enum Kind { kPicture, kNothing, kError, kDamaged } kind = kPicture;
  std::uint32_t sequence = 0;
};

struct World {
  DeviceTime now{1'700'000'000'000 * kMs};
  std::deque<Step> steps;
  int starts = 0, stops = 0, refuse_starts = 0;
  SensorClock clock = SensorClock::kMonotonic;
  PixelFormat format = PixelFormat::kGrey;
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(8 * 6, 7);
  std::vector<std::string> notes;
  std::optional<Duration> exposure;
  CameraConfig adjusted;
  std::atomic<bool> stop{false};
  std::int64_t picture_age_ns = 12 * kMs;
};

class ScriptedCamera : public CameraDevice {
 public:
  explicit ScriptedCamera(World& world) : world_(world) {}
  [[nodiscard]] Result<CameraMode> start(const CameraConfig&) override {
    ++world_.starts;
    if (world_.refuse_starts-- > 0) return Error{ErrorCode::kNotFound, "no such camera", "/dev/video0"};
    return CameraMode{world_.format, "", world_.notes};
  }
  [[nodiscard]] Result<std::optional<CapturedImage>> next(Duration wait) override {
    if (world_.steps.empty()) {
      world_.stop = true;
      return std::optional<CapturedImage>();
    }
    const Step step = world_.steps.front();
    world_.steps.pop_front();
    if (step.kind == Step::kError) return Error{ErrorCode::kNotFound, "the camera is gone", "/dev/video0"};
    world_.now = world_.now + (step.kind == Step::kNothing ? wait : Duration{33 * kMs});
    if (step.kind == Step::kNothing) return std::optional<CapturedImage>();
    CapturedImage image;
    image.format = world_.format;
    image.width_px = image.stride_bytes = 8;
    image.height_px = 6;
    image.bytes = world_.bytes;
    image.stamp = {world_.clock, StampInstant::kReadoutStart,
                   world_.now.ns - kDeviceLessMonotonic - world_.picture_age_ns};
    image.sequence = step.sequence;
    image.exposure = world_.exposure;
    image.damaged = step.kind == Step::kDamaged;
    return std::optional(image);
  }
  [[nodiscard]] std::vector<std::string> adjust(const CameraConfig& config) override {
    world_.adjusted = config;
    return {};
  }
  void stop() override { ++world_.stops; }
  static constexpr std::int64_t kDeviceLessMonotonic = 1'600'000'000'000 * kMs;

 private:
  World& world_;
};

Config small_config() {
  Config config;
  config.camera.width_px = 8;
  config.camera.height_px = 6;
  return config;
}

struct Bench {
  explicit Bench(const Config& config = small_config()) : config_(config) {}
  void open() {
    source = std::make_unique<CameraSource>(
        CameraSource::Parts{
            std::make_unique<ScriptedCamera>(world), [this] { return world.now; },
            [] {
              return ClockOffsets{ScriptedCamera::kDeviceLessMonotonic, ScriptedCamera::kDeviceLessMonotonic};
            },
            [this](Duration pause) { world.now = world.now + pause; }, counters},
        config_, world.stop);
  }
  // To the end of the script.
  void run() {
    if (source == nullptr) open();
    for (auto next = source->next(); next.ok() && next.value(); next = source->next()) {
      if (auto* frame = std::get_if<Frame>(&*next.value())) frames.push_back(*frame);
      if (auto* fault = std::get_if<Fault>(&*next.value())) faults.push_back(fault->text);
      if (std::holds_alternative<Start>(*next.value())) ++begun;
    }
  }
  void pictures(std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t k = from; k < to; ++k) world.steps.push_back({Step::kPicture, k});
  }

  World world;
  std::shared_ptr<CameraCounters> counters = std::make_shared<CameraCounters>();
  Config config_;
  std::unique_ptr<CameraSource> source;
  std::vector<Frame> frames;
  std::vector<std::string> faults;
  int begun = 0;
};

TEST(CameraSource, BeginsWithAStartAndGivesEveryPictureAtMidExposure) {
  Bench bench;
  bench.world.exposure = Duration{10 * kMs};
  bench.pictures(0, 3);
  bench.run();
  EXPECT_EQ(bench.begun, 1);
  EXPECT_TRUE(bench.faults.empty());
  ASSERT_EQ(bench.frames.size(), 3u);
  EXPECT_EQ(bench.frames[2].time.ns, bench.world.now.ns - 12 * kMs - 5 * kMs) << "the stamp, less half the exposure";
  EXPECT_EQ(bench.frames[2].sequence, 2);
  EXPECT_EQ(*bench.frames[2].grey, bench.world.bytes);
  EXPECT_EQ(bench.counters->frames, 3u);
}

TEST(CameraSource, TheConfiguredDelayIsAdded) {
  Config config = small_config();
  config.camera.time_offset_s = -0.004;
  Bench bench(config);
  bench.pictures(0, 1);
  bench.run();
  ASSERT_EQ(bench.frames.size(), 1u);
  EXPECT_EQ(bench.frames[0].time.ns, bench.world.now.ns - 12 * kMs - 4 * kMs);
}

TEST(CameraSource, AnAbsentCameraIsToldOnceAndTriedUntilItIsThere) {
  Bench bench;
  bench.world.refuse_starts = 5;
  bench.pictures(0, 2);
  bench.run();
  EXPECT_EQ(bench.world.starts, 6);
  EXPECT_EQ(bench.frames.size(), 2u);
  EXPECT_THAT(bench.faults, ::testing::ElementsAre("/dev/video0: no such camera"));
}

TEST(CameraSource, AStalledCameraBecomesAFaultAndIsStartedAnew) {
  Bench bench;
  bench.pictures(0, 2);
  for (int k = 0; k < 21; ++k) bench.world.steps.push_back({Step::kNothing, 0});  // 1.05 s
  bench.pictures(0, 2);
  bench.run();
  EXPECT_EQ(bench.world.starts, 2);
  EXPECT_THAT(bench.faults, ::testing::ElementsAre(HasSubstr("no picture for 1000 ms")));
  ASSERT_EQ(bench.frames.size(), 4u);
  for (std::size_t k = 1; k < 4; ++k) {
    EXPECT_GT(bench.frames[k].time, bench.frames[k - 1].time);
    EXPECT_GT(bench.frames[k].sequence, bench.frames[k - 1].sequence);
  }
  EXPECT_EQ(bench.counters->restarts, 1u);
  EXPECT_EQ(bench.counters->lost, 0u) << "the pause of a restart is no gap";
}

TEST(CameraSource, AShortPauseIsNoStall) {
  Bench bench;
  bench.pictures(0, 1);
  for (int k = 0; k < 19; ++k) bench.world.steps.push_back({Step::kNothing, 0});  // 0.95 s
  bench.pictures(1, 2);
  bench.run();
  EXPECT_EQ(bench.world.starts, 1);
  EXPECT_TRUE(bench.faults.empty());
}

TEST(CameraSource, APulledCameraIsAFaultAndComesBack) {
  Bench bench;
  bench.pictures(0, 1);
  bench.world.steps.push_back({Step::kError, 0});
  bench.pictures(0, 1);
  bench.run();
  EXPECT_EQ(bench.frames.size(), 2u);
  EXPECT_THAT(bench.faults, ::testing::ElementsAre("/dev/video0: the camera is gone"));
}

TEST(CameraSource, LostPicturesAreCountedAndTold) {
  Bench bench;
  bench.pictures(0, 2);
  bench.pictures(5, 40);  // 2, 3 and 4 never came
  bench.run();
  EXPECT_EQ(bench.counters->lost, 3u);
  EXPECT_THAT(bench.faults, ::testing::ElementsAre("3 pictures were lost on the way"));
  EXPECT_EQ(bench.frames[2].sequence, 5) << "the sequence shows where";
}

TEST(CameraSource, DamagedPicturesAreCountedAndNotUsed) {
  Bench bench;
  bench.pictures(0, 1);
  bench.world.steps.push_back({Step::kDamaged, 1});
  bench.pictures(2, 3);
  bench.run();
  EXPECT_EQ(bench.frames.size(), 2u);
  EXPECT_EQ(bench.counters->damaged, 1u);
  EXPECT_EQ(bench.counters->lost, 0u);
}

TEST(CameraSource, ACameraWithOnlyDamagedPicturesIsStalled) {
  Bench bench;
  for (std::uint32_t k = 0; k < 40; ++k) bench.world.steps.push_back({Step::kDamaged, k});
  bench.run();
  EXPECT_GE(bench.world.starts, 2);
}

TEST(CameraSource, StampsOfAnUnknownClockGiveWayToTheArrival) {
  Bench bench;
  bench.world.clock = SensorClock::kUnknown;
  bench.pictures(0, 2);
  bench.run();
  ASSERT_EQ(bench.frames.size(), 2u);
  EXPECT_EQ(bench.frames[1].time, bench.world.now);
  EXPECT_THAT(bench.faults, ::testing::ElementsAre(HasSubstr("time stamps")));
}

TEST(CameraSource, TimeNeverTurnsRound) {
  Bench bench;
  bench.pictures(0, 1);
  bench.open();
  ASSERT_TRUE(bench.source->next().ok());
  ASSERT_TRUE(bench.source->next().ok());
  bench.world.picture_age_ns = 500 * kMs;
  bench.pictures(1, 2);
  bench.run();
  EXPECT_TRUE(bench.frames.empty()) << "older than the one before";
}

TEST(CameraSource, MjpegIsJournalledAsItCameUnlessItIsCut) {
  std::vector<std::uint8_t> jpeg;
  ASSERT_TRUE(cv::imencode(".jpg", cv::Mat(6, 8, CV_8UC1, cv::Scalar(99)), jpeg));
  Config config = small_config();
  for (const bool cut : {false, true}) {
    config.camera.crop_width_px = cut ? 4 : 0;
    Bench bench(config);
    bench.world.format = PixelFormat::kMjpeg;
    bench.world.bytes = jpeg;
    bench.pictures(0, 1);
    bench.run();
    ASSERT_EQ(bench.frames.size(), 1u);
    EXPECT_EQ(bench.frames[0].width_px, cut ? 4 : 8);
    EXPECT_EQ(bench.frames[0].grey->size(), cut ? 24u : 48u);
    EXPECT_NEAR(bench.frames[0].grey->front(), 99, 2);
    EXPECT_EQ(bench.frames[0].encoded != nullptr, !cut);
    if (!cut) {
      EXPECT_EQ(*bench.frames[0].encoded, jpeg);
    }
  }
}

TEST(CameraSource, WithJpegInTheJournalTheEstimatorSeesWhatTheJournalHolds) {
  Config config = small_config();
  config.journal.frames = "jpeg";
  Bench bench(config);
  for (std::size_t k = 0; k < bench.world.bytes.size(); ++k) bench.world.bytes[k] = static_cast<std::uint8_t>(97 * k);
  bench.pictures(0, 1);
  bench.run();
  ASSERT_EQ(bench.frames.size(), 1u);
  ASSERT_NE(bench.frames[0].encoded, nullptr);
  const cv::Mat decoded = cv::imdecode(*bench.frames[0].encoded, cv::IMREAD_GRAYSCALE);
  EXPECT_EQ(std::vector<std::uint8_t>(decoded.data, decoded.data + 48), *bench.frames[0].grey);
  EXPECT_NE(*bench.frames[0].grey, bench.world.bytes) << "noise does not survive JPEG";
}

TEST(CameraSource, AnAdjustmentReachesTheCamera) {
  Bench bench;
  bench.pictures(0, 1);
  bench.open();
  ASSERT_TRUE(bench.source->next().ok());
  ASSERT_TRUE(bench.source->next().ok());
  bench.source->adjust(0.006, 2.5);
  bench.pictures(1, 2);
  bench.run();
  EXPECT_EQ(bench.world.adjusted.exposure_s, 0.006);
  EXPECT_EQ(bench.world.adjusted.gain, 2.5);
  ASSERT_EQ(bench.frames.size(), 1u);
  EXPECT_EQ(bench.frames[0].time.ns, bench.world.now.ns - 12 * kMs - 3 * kMs) << "and the time of its pictures";
}

TEST(CameraSource, WhatTheCameraCannotDoIsTold) {
  Bench bench;
  bench.world.notes = {"/dev/video0: has no control of its gain"};
  bench.pictures(0, 1);
  bench.world.steps.push_back({Step::kError, 0});
  bench.pictures(0, 1);
  bench.run();
  EXPECT_THAT(bench.faults, ::testing::ElementsAre("/dev/video0: has no control of its gain",
                                                   "/dev/video0: the camera is gone"))
      << "once";
}

}  // namespace
}  // namespace rfmvo
