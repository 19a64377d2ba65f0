// What cameras share, without any camera: grey levels out of formats, times, gaps, restarts.
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "edges/camera/captured_image.hpp"
#include "edges/camera/clock_offsets.hpp"
#include "edges/camera/frame_gaps.hpp"
#include "edges/camera/restart_policy.hpp"
#include "edges/camera/sensor_time.hpp"

namespace rfmvo {
namespace {

constexpr std::int64_t kMs = 1'000'000, kSecond = 1'000 * kMs;

std::uint8_t level(int x, int y) { return static_cast<std::uint8_t>(17 * x + 31 * y); }

// A picture of level(x, y) in the driver's layout; what is not grey is 0xEE.
struct Picture {
  Picture(PixelFormat format, int width, int height, int padding) {
    const int step = format == PixelFormat::kYuyv ? 2 : 1;
    image.stride_bytes = static_cast<std::size_t>(width * step + padding);
    bytes.assign(image.stride_bytes * static_cast<std::size_t>(height) * 3 / 2, 0xEE);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        bytes[static_cast<std::size_t>(y) * image.stride_bytes + static_cast<std::size_t>(x * step)] = level(x, y);
    image.format = format;
    image.width_px = width;
    image.height_px = height;
    image.bytes = bytes;
  }
  std::vector<std::uint8_t> bytes;
  CapturedImage image;
};

constexpr PixelFormat kPlain[] = {PixelFormat::kGrey, PixelFormat::kNv12, PixelFormat::kYuv420, PixelFormat::kYuyv};

TEST(GreyOf, EveryFormatGivesTheSameGreyLevelsWhateverTheStride) {
  for (const PixelFormat format : kPlain)
    for (const int padding : {0, 1, 63}) {
      const Picture picture(format, 9, 5, padding);
      const auto grey = grey_of(picture.image, {0, 0, 9, 5});
      ASSERT_TRUE(grey.ok()) << name_of(format);
      ASSERT_EQ(grey.value()->size(), 45u);
      for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 9; ++x) ASSERT_EQ((*grey.value())[static_cast<std::size_t>(9 * y + x)], level(x, y));
    }
}

TEST(GreyOf, CutsFirstAndFlipsTheRest) {
  for (const PixelFormat format : kPlain) {
    const Picture picture(format, 9, 5, 7);
    const ImageWindow window{2, 1, 4, 3, true, true};
    const auto grey = grey_of(picture.image, window);
    ASSERT_TRUE(grey.ok());
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x)
        EXPECT_EQ((*grey.value())[static_cast<std::size_t>(4 * y + x)], level(2 + 3 - x, 1 + 2 - y));
  }
}

TEST(GreyOf, FlippingTwiceIsNothing) {
  const Picture picture(PixelFormat::kGrey, 9, 5, 3);
  for (const bool horizontal : {false, true}) {
    const ImageWindow flip{0, 0, 9, 5, horizontal, !horizontal};
    const auto once = grey_of(picture.image, flip);
    ASSERT_TRUE(once.ok());
    const auto twice = cut(*once.value(), 9, 5, flip);
    EXPECT_EQ(*twice, *grey_of(picture.image, {0, 0, 9, 5}).value());
  }
}

TEST(GreyOf, APictureThatIsTooShortIsAnErrorAtEveryLength) {
  for (const PixelFormat format : kPlain) {
    Picture picture(format, 9, 5, 3);
    const std::size_t row = format == PixelFormat::kYuyv ? 18 : 9;
    const std::size_t needed = 4 * picture.image.stride_bytes + row;
    for (std::size_t size = 0; size <= needed + 1; ++size) {
      // On the heap and exactly so long, so that the sanitizers see a byte too many.
      const std::vector<std::uint8_t> exact(picture.bytes.begin(),
                                            picture.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      picture.image.bytes = exact;
      EXPECT_EQ(grey_of(picture.image, {0, 0, 9, 5}).ok(), size >= needed) << size;
    }
    picture.image.bytes = picture.bytes;
    picture.image.stride_bytes = row - 1;
    EXPECT_FALSE(grey_of(picture.image, {0, 0, 9, 5}).ok()) << "rows overlap";
  }
}

TEST(GreyOf, AWindowOutsideIsAnError) {
  const Picture picture(PixelFormat::kGrey, 9, 5, 0);
  for (const ImageWindow& window :
       {ImageWindow{-1, 0, 3, 3}, ImageWindow{7, 0, 3, 3}, ImageWindow{0, 3, 3, 3}, ImageWindow{0, 0, 0, 3},
        ImageWindow{0, 0, 10, 5}, ImageWindow{std::numeric_limits<int>::max(), 0, 2, 2}})
    EXPECT_FALSE(grey_of(picture.image, window).ok());
}

TEST(ImageWindow, IsWhatTheConfigurationSays) {
  CameraConfig config;
  config.width_px = 640;
  config.height_px = 480;
  config.crop_x_px = 40;
  config.crop_height_px = 100;
  config.flip = "vertical";
  const ImageWindow window = window_of(config);
  EXPECT_EQ(window.x_px, 40);
  EXPECT_EQ(window.width_px, 600) << "to the right edge";
  EXPECT_EQ(window.height_px, 100);
  EXPECT_TRUE(window.flip_vertical);
  EXPECT_FALSE(window.flip_horizontal);
}

TEST(SensorTime, EachClockHasItsOwnOffset) {
  const ClockOffsets offsets{1'000 * kSecond, 400 * kSecond};  // the box slept for 600 s
  const DeviceTime arrival{2'000 * kSecond};
  const auto at = [&](SensorClock clock, std::int64_t ns) {
    return device_time({clock, StampInstant::kReadoutEnd, ns}, offsets, arrival);
  };
  EXPECT_EQ(at(SensorClock::kMonotonic, 999 * kSecond), DeviceTime{1'999 * kSecond});
  EXPECT_EQ(at(SensorClock::kBoottime, 1'599 * kSecond), DeviceTime{1'999 * kSecond});
  EXPECT_EQ(at(SensorClock::kUnknown, 999 * kSecond), std::nullopt);
}

TEST(SensorTime, AStampOfAnotherClockIsNotBelieved) {
  const ClockOffsets offsets{1'000 * kSecond, 1'000 * kSecond};
  const DeviceTime arrival{2'000 * kSecond};
  constexpr std::int64_t kExtremes[] = {0, -1, std::numeric_limits<std::int64_t>::max(),
                                        std::numeric_limits<std::int64_t>::min(), 1'700'000'000 * kSecond};
  for (const std::int64_t ns : kExtremes)
    EXPECT_EQ(device_time({SensorClock::kMonotonic, StampInstant::kReadoutEnd, ns}, offsets, arrival), std::nullopt);
}

// Row r of the sensor is exposed from r * line - exposure to r * line after the first row's readout begins. The middle
// of the exposure of the used rows' middle is the same time, whichever moment the driver stamped.
TEST(SensorTime, MidExposureDoesNotDependOnWhatWasStamped) {
  const std::int64_t readout_start = 5 * kSecond;
  for (const std::int64_t exposure : {0 * kMs, 4 * kMs, 30 * kMs})
    for (const std::int64_t readout : {0 * kMs, 16 * kMs})
      for (const double share : {0.25, 0.5}) {
        const ShutterTiming shutter{{exposure}, {readout}, share};
        const std::int64_t expected =
            readout_start - exposure / 2 + static_cast<std::int64_t>(share * static_cast<double>(readout));
        EXPECT_EQ(readout_start + to_mid_exposure(StampInstant::kReadoutStart, shutter).ns, expected);
        EXPECT_EQ(readout_start - exposure + to_mid_exposure(StampInstant::kExposureStart, shutter).ns, expected);
        EXPECT_EQ(readout_start + readout + to_mid_exposure(StampInstant::kReadoutEnd, shutter).ns, expected);
      }
}

TEST(ClockOffsets, AreThoseOfTheKernelsClocks) {
  const DeviceClockFunction clock = device_clock();
  const ClockOffsets offsets = read_clock_offsets(clock);
  timespec monotonic{};
  const DeviceTime before = clock();
  ASSERT_EQ(::clock_gettime(CLOCK_MONOTONIC, &monotonic), 0);
  const DeviceTime after = clock();
  const std::int64_t now = monotonic.tv_sec * kSecond + monotonic.tv_nsec + offsets.device_less_monotonic_ns;
  EXPECT_GE(now, before.ns - kMs);
  EXPECT_LE(now, after.ns + kMs);
}

TEST(FrameGaps, CountWhatIsMissingAcrossTheWrap) {
  FrameGaps gaps;
  constexpr std::uint32_t kLast = std::numeric_limits<std::uint32_t>::max();
  std::int64_t sequence = gaps.on(kLast - 1).sequence;
  EXPECT_EQ(gaps.on(kLast).lost, 0u);
  const auto wrapped = gaps.on(3);  // 0, 1 and 2 never came
  EXPECT_EQ(wrapped.lost, 3u);
  EXPECT_EQ(wrapped.sequence, sequence + 5);
  EXPECT_EQ(gaps.lost(), 3u);
}

TEST(FrameGaps, ACounterThatBeginsAnewLosesNothing) {
  FrameGaps gaps;
  (void)gaps.on(100);
  EXPECT_EQ(gaps.on(0).lost, 0u) << "the driver began anew";
  EXPECT_EQ(gaps.on(0).lost, 0u) << "a driver that does not count";
  gaps.on_restart();
  EXPECT_EQ(gaps.on(50).lost, 0u);
  EXPECT_EQ(gaps.on(51).sequence, 4) << "our own count goes on";
}

TEST(RestartPolicy, StallsOnlyAfterTheLimitWithoutAPicture) {
  RestartPolicy policy(Duration{kSecond}, DeviceTime{0});
  policy.on_started(DeviceTime{0});
  EXPECT_FALSE(policy.is_stalled(DeviceTime{kSecond}));
  EXPECT_TRUE(policy.is_stalled(DeviceTime{kSecond + 1}));
  policy.on_picture(DeviceTime{kSecond});
  EXPECT_FALSE(policy.is_stalled(DeviceTime{2 * kSecond}));
}

TEST(RestartPolicy, WaitsLongerEachTimeUpToALimitUntilAPictureCame) {
  RestartPolicy policy(Duration{kSecond}, DeviceTime{0});
  const auto pause_after_failure = [&](DeviceTime now) {
    policy.on_failure(now);
    std::int64_t ms = 0;
    while (!policy.may_try(now + Duration{ms * kMs})) ++ms;
    return ms;
  };
  EXPECT_TRUE(policy.may_try(DeviceTime{0}));
  std::int64_t last = 0;
  for (int k = 0; k < 10; ++k) {
    const std::int64_t pause = pause_after_failure(DeviceTime{k * 10 * kSecond});
    EXPECT_GE(pause, last);
    EXPECT_LE(pause, 2000);
    last = pause;
  }
  EXPECT_EQ(last, 2000);
  policy.on_picture(DeviceTime{200 * kSecond});
  EXPECT_LT(pause_after_failure(DeviceTime{200 * kSecond}), 500) << "it worked: soon again";
}

}  // namespace
}  // namespace rfmvo
