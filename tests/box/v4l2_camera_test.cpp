// The V4L2 camera against a driver that is strict about the protocol.
#include "edges/camera/v4l2_camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <map>
#include <set>

namespace rfmvo {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// What a driver is: formats, controls, buffers that are either the program's or its own.
struct Driver {
  std::vector<std::uint32_t> formats{V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_GREY};
  std::map<std::uint32_t, std::int32_t> controls{{V4L2_CID_EXPOSURE_AUTO, 3}, {V4L2_CID_EXPOSURE_ABSOLUTE, 157}};
  std::string name = "sensor";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::uint32_t width = 0, padding = 0, buffers = 4;  // width 0: what is asked for
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  std::map<unsigned long, int> refuses;  // request -> errno
  bool has_rate = true;

  v4l2_pix_format format{};
  v4l2_fract period{};
  std::vector<std::vector<std::uint8_t>> memory;
  std::set<std::uint32_t> queued;
  std::deque<v4l2_buffer> filled;
  bool open = false, streaming = false, gone = false;
  int mapped = 0, opened = 0;
  std::vector<std::string> violations;

  void expect(bool condition, const std::string& what) {
    if (!condition) violations.push_back(what);
  }
  // The sensor has a picture; false if the driver has no buffer for it.
  bool take(std::uint32_t sequence, std::int64_t us, std::uint8_t level, std::uint32_t more_flags = 0) {
    if (queued.empty()) return false;
    v4l2_buffer buffer{};
    buffer.index = *queued.begin();
    queued.erase(queued.begin());
    std::fill(memory[buffer.index].begin(), memory[buffer.index].end(), level);
    buffer.bytesused = static_cast<std::uint32_t>(memory[buffer.index].size());
    buffer.sequence = sequence;
    buffer.flags = flags | more_flags;
    buffer.timestamp = {us / 1'000'000, us % 1'000'000};
    filled.push_back(buffer);
    return true;
  }
};

class DriverNode : public V4l2Node {
 public:
  explicit DriverNode(Driver& driver) : d_(driver) {
    d_.expect(!d_.open, "opened twice");
    d_.open = true;
    ++d_.opened;
  }
  ~DriverNode() override {
    d_.expect(d_.mapped == 0, "closed while mapped");
    d_.open = d_.streaming = false;
    d_.queued.clear();
    d_.filled.clear();
  }

  [[nodiscard]] int control(unsigned long request, void* argument) override {
    if (d_.gone) return ENODEV;
    if (const auto refused = d_.refuses.find(request); refused != d_.refuses.end()) return refused->second;
    switch (request) {
      case VIDIOC_QUERYCAP:
        return query(*static_cast<v4l2_capability*>(argument));
      case VIDIOC_ENUM_FMT:
        return enumerate(*static_cast<v4l2_fmtdesc*>(argument));
      case VIDIOC_S_FMT:
        return set_format(*static_cast<v4l2_format*>(argument));
      case VIDIOC_S_PARM:
        return set_rate(*static_cast<v4l2_streamparm*>(argument));
      case VIDIOC_S_CTRL:
        return set_control(*static_cast<v4l2_control*>(argument));
      case VIDIOC_G_CTRL:
        return get_control(*static_cast<v4l2_control*>(argument));
      case VIDIOC_REQBUFS:
        return request_buffers(*static_cast<v4l2_requestbuffers*>(argument));
      case VIDIOC_QUERYBUF:
        return query_buffer(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_QBUF:
        return queue(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_DQBUF:
        return dequeue(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_STREAMON:
        d_.streaming = true;
        return 0;
      case VIDIOC_STREAMOFF:
        d_.streaming = false;
        return 0;
      default:
        return ENOTTY;
    }
  }
  [[nodiscard]] const std::uint8_t* map(std::size_t bytes, std::int64_t offset) override {
    const auto index = static_cast<std::size_t>(offset) / 4096;
    d_.expect(index < d_.memory.size() && d_.memory[index].size() == bytes, "mapped what is not there");
    ++d_.mapped;
    return d_.memory[index].data();
  }
  void unmap(const std::uint8_t*, std::size_t) override { --d_.mapped; }
  [[nodiscard]] bool wait(Duration) override { return d_.gone || !d_.filled.empty(); }

 private:
  int query(v4l2_capability& out) {
    out.capabilities = d_.capabilities | V4L2_CAP_DEVICE_CAPS;
    out.device_caps = d_.capabilities;
    std::strncpy(reinterpret_cast<char*>(out.card), "Camera", sizeof(out.card) - 1);
    std::strncpy(reinterpret_cast<char*>(out.driver), d_.name.c_str(), sizeof(out.driver) - 1);
    return 0;
  }
  int enumerate(v4l2_fmtdesc& out) {
    if (out.index >= d_.formats.size()) return EINVAL;
    out.pixelformat = d_.formats[out.index];
    return 0;
  }
  int set_format(v4l2_format& out) {
    v4l2_pix_format& pix = out.fmt.pix;
    if (d_.width != 0) pix.width = d_.width;
    pix.bytesperline = pix.width * (pix.pixelformat == V4L2_PIX_FMT_YUYV ? 2 : 1) + d_.padding;
    d_.format = pix;
    return 0;
  }
  int set_rate(v4l2_streamparm& out) {
    if (!d_.has_rate) return ENOTTY;
    out.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
    d_.period = out.parm.capture.timeperframe;
    return 0;
  }
  int set_control(const v4l2_control& in) {
    const auto found = d_.controls.find(in.id);
    if (found == d_.controls.end()) return EINVAL;
    found->second = in.value;
    return 0;
  }
  int get_control(v4l2_control& out) {
    const auto found = d_.controls.find(out.id);
    if (found == d_.controls.end()) return EINVAL;
    out.value = found->second;
    return 0;
  }
  int request_buffers(v4l2_requestbuffers& out) {
    out.count = std::min(out.count, d_.buffers);
    d_.memory.assign(out.count,
                     std::vector<std::uint8_t>(std::size_t{d_.format.bytesperline} * d_.format.height * 3 / 2));
    return 0;
  }
  int query_buffer(v4l2_buffer& out) {
    if (out.index >= d_.memory.size()) return EINVAL;
    out.length = static_cast<std::uint32_t>(d_.memory[out.index].size());
    out.m.offset = out.index * 4096;
    return 0;
  }
  int queue(const v4l2_buffer& in) {
    d_.expect(in.index < d_.memory.size() && d_.queued.insert(in.index).second, "queued what it does not own");
    return 0;
  }
  int dequeue(v4l2_buffer& out) {
    d_.expect(d_.streaming, "a picture before streaming");
    if (d_.filled.empty()) return EAGAIN;
    out = d_.filled.front();
    d_.filled.pop_front();
    return 0;
  }
  Driver& d_;
};

struct V4l2CameraTest : ::testing::Test {
  V4l2CameraTest() {
    config.width_px = 8;
    config.height_px = 6;
  }
  ~V4l2CameraTest() override {
    camera.stop();
    EXPECT_THAT(driver.violations, ElementsAre());
    EXPECT_FALSE(driver.open) << "stop() closes";
  }
  std::string error_of_start() {
    const auto mode = camera.start(config);
    return mode.ok() ? "" : mode.error().text();
  }
  CapturedImage next() {
    auto image = camera.next(Duration{1});
    EXPECT_TRUE(image.ok() && image.value());
    return image.ok() && image.value() ? *image.value() : CapturedImage{};
  }

  Driver driver;
  CameraConfig config;
  V4l2Camera camera{"/dev/video0", [this](const std::string&) -> Result<std::unique_ptr<V4l2Node>> {
                      if (driver.gone) return Error{ErrorCode::kNotFound, "no such camera", "/dev/video0"};
                      return std::unique_ptr<V4l2Node>(std::make_unique<DriverNode>(driver));
                    }};
};

TEST_F(V4l2CameraTest, PicturesComeInOrderWithTheirStampsAndBuffersGoBack) {
  ASSERT_EQ(error_of_start(), "");
  for (std::uint32_t k = 0; k < 20; ++k) {  // many more than buffers
    ASSERT_TRUE(driver.take(k, 1'000'000 + 33'333 * k, static_cast<std::uint8_t>(k))) << "a buffer never came back";
    const CapturedImage image = next();
    EXPECT_EQ(image.sequence, k);
    EXPECT_EQ(image.stamp.ns, (1'000'000 + 33'333 * std::int64_t{k}) * 1000);
    EXPECT_EQ(image.stamp.clock, SensorClock::kMonotonic);
    EXPECT_EQ(image.stamp.instant, StampInstant::kReadoutEnd);
    EXPECT_EQ(image.bytes[47], k);
  }
  EXPECT_FALSE(camera.next(Duration{1}).value().has_value()) << "nothing more";
}

TEST_F(V4l2CameraTest, APictureStaysUntouchedUntilTheNextIsAskedFor) {
  ASSERT_EQ(error_of_start(), "");
  ASSERT_TRUE(driver.take(0, 1, 11));
  const CapturedImage image = next();
  for (std::uint32_t k = 1; driver.take(k, 1, 99); ++k) {
  }
  EXPECT_EQ(image.bytes[0], 11);
  EXPECT_EQ(driver.queued.size(), 0u) << "all others were given to the driver";
}

TEST_F(V4l2CameraTest, GreyIsBestUnlessAnotherFormatIsAskedFor) {
  ASSERT_EQ(error_of_start(), "");
  EXPECT_EQ(driver.format.pixelformat, V4L2_PIX_FMT_GREY);
  config.format = "yuyv";
  driver.padding = 16;
  ASSERT_EQ(error_of_start(), "");
  EXPECT_EQ(driver.format.pixelformat, V4L2_PIX_FMT_YUYV);
  ASSERT_TRUE(driver.take(0, 1, 1));
  EXPECT_EQ(next().stride_bytes, 32u) << "the driver pads its rows";
  config.format = "mjpg";
  EXPECT_EQ(error_of_start(), "/dev/video0: has no \"mjpg\", but grey, yuyv");
  driver.formats = {V4L2_PIX_FMT_SRGGB10};
  EXPECT_EQ(error_of_start(), "/dev/video0: has none of grey, nv12, yuv420, yuyv, mjpg");
}

TEST_F(V4l2CameraTest, ExposureGainAndRateReachTheDriver) {
  driver.controls[V4L2_CID_GAIN] = 1;
  config.exposure_s = 0.0054;
  config.gain = 20;
  config.frame_rate_hz = 12.5;
  ASSERT_EQ(error_of_start(), "");
  EXPECT_EQ(driver.controls[V4L2_CID_EXPOSURE_AUTO], V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(driver.controls[V4L2_CID_EXPOSURE_ABSOLUTE], 54);
  EXPECT_EQ(driver.controls[V4L2_CID_GAIN], 20);
  EXPECT_DOUBLE_EQ(static_cast<double>(driver.period.denominator) / driver.period.numerator, 12.5);
  ASSERT_TRUE(driver.take(0, 1, 1));
  EXPECT_EQ(next().exposure, Duration{5'400'000});
  config.exposure_s = 0.002;
  EXPECT_THAT(camera.adjust(config), ElementsAre());
  EXPECT_EQ(driver.controls[V4L2_CID_EXPOSURE_ABSOLUTE], 20);
}

TEST_F(V4l2CameraTest, WhatItCannotDoIsANoteNotAnError) {
  driver.controls.clear();
  driver.has_rate = false;
  config.exposure_s = 0.005;
  config.gain = 2;
  const auto mode = camera.start(config);
  ASSERT_TRUE(mode.ok());
  EXPECT_THAT(mode.value().notes, ElementsAre(HasSubstr("frame rate"), HasSubstr("exposure"), HasSubstr("gain")));
  ASSERT_TRUE(driver.take(0, 1, 1));
  EXPECT_EQ(next().exposure, std::nullopt);
}

TEST_F(V4l2CameraTest, ClocksAreToldApartByType) {
  const auto stamp_with = [&](std::uint32_t flags) {
    driver.flags = flags;
    EXPECT_EQ(error_of_start(), "");
    EXPECT_TRUE(driver.take(0, 1, 1));
    return next().stamp;
  };
  EXPECT_EQ(stamp_with(V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE).instant,
            StampInstant::kExposureStart);
  EXPECT_EQ(stamp_with(V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN).clock, SensorClock::kUnknown);
  EXPECT_EQ(stamp_with(V4L2_BUF_FLAG_TIMESTAMP_COPY).clock, SensorClock::kUnknown);
  driver.name = "uvcvideo";  // its SOE is the first packet
  EXPECT_EQ(stamp_with(V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE).instant,
            StampInstant::kReadoutStart);
}

TEST_F(V4l2CameraTest, ADamagedPictureIsMarked) {
  ASSERT_EQ(error_of_start(), "");
  ASSERT_TRUE(driver.take(0, 1, 1, V4L2_BUF_FLAG_ERROR));
  EXPECT_TRUE(next().damaged);
}

TEST_F(V4l2CameraTest, EveryRefusalIsOneLineThatNamesTheDevice) {
  for (const auto& [request, error, text] :
       std::vector<std::tuple<unsigned long, int, std::string>>{{VIDIOC_QUERYCAP, ENOTTY, "not a V4L2 device"},
                                                                {VIDIOC_S_FMT, EBUSY, "another program uses it"},
                                                                {VIDIOC_REQBUFS, ENOMEM, "gives no buffers"},
                                                                {VIDIOC_QUERYBUF, EINVAL, "loses a buffer"},
                                                                {VIDIOC_QBUF, EIO, "takes no buffer"},
                                                                {VIDIOC_STREAMON, ENOSPC, "does not start"}}) {
    driver.refuses = {{request, error}};
    EXPECT_THAT(error_of_start(), ::testing::AllOf(::testing::StartsWith("/dev/video0: "), HasSubstr(text)));
  }
  driver.refuses.clear();
  driver.width = 1280;
  EXPECT_EQ(error_of_start(), "/dev/video0: gives 1280 x 6 instead of 8 x 6 px of grey");
  driver.width = 0;
  driver.buffers = 1;
  EXPECT_THAT(error_of_start(), HasSubstr("memory for one picture only"));
  driver.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  EXPECT_THAT(error_of_start(), HasSubstr("single-planar"));
}

TEST_F(V4l2CameraTest, APulledCameraIsAnErrorAndCanBeStartedOnceItIsBack) {
  ASSERT_EQ(error_of_start(), "");
  driver.gone = true;
  const auto image = camera.next(Duration{1});
  ASSERT_FALSE(image.ok());
  EXPECT_EQ(image.error().text(), "/dev/video0: the camera is gone");
  camera.stop();
  EXPECT_EQ(error_of_start(), "/dev/video0: no such camera");
  driver.gone = false;
  EXPECT_EQ(error_of_start(), "");
  ASSERT_TRUE(driver.take(7, 1, 1));
  EXPECT_EQ(next().sequence, 7u);
}

}  // namespace
}  // namespace rfmvo
