#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "edges/lcm_codec.hpp"
#include "rfmvo/camera_pose_t.hpp"
#include "rfmvo/tag_read_t.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

const std::string kPrefix = "RFMVO_";

template <class Message>
std::vector<std::uint8_t> bytes_of(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

tag_read_t good_read() {
  tag_read_t m{};
  m.epc = {1, 2};
  m.epc_size = 2;
  m.port = 1;
  m.frequency_hz = 920'000'000;
  m.seen_count = 1;
  return m;
}

std::string error_of_read(const tag_read_t& m) {
  const auto event = decode_event("RFMVO_TAG_READ", bytes_of(m), kPrefix);
  return event.ok() ? "" : event.error().text();
}

TEST(LcmCodec, EveryEventComesBackToTheLastBit) {
  for (const Event& event : testing::one_of_each_event()) {
    const LcmMessage message = encode(event, kPrefix);
    ASSERT_TRUE(is_event_channel(message.channel, kPrefix)) << message.channel;
    EXPECT_FALSE(is_estimate_channel(message.channel, kPrefix));
    EXPECT_EQ(message.utime, time_of(event).us());
    const auto back = decode_event(message.channel, message.data, kPrefix);
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(back.value().index(), event.index());
    EXPECT_EQ(encode(back.value(), kPrefix).data, message.data) << message.channel;
  }
}

TEST(LcmCodec, EveryEstimateComesBackToTheLastBit) {
  for (const Estimate& estimate : testing::one_of_each_estimate()) {
    const LcmMessage message = encode(estimate, kPrefix).front();
    ASSERT_TRUE(is_estimate_channel(message.channel, kPrefix)) << message.channel;
    EXPECT_FALSE(is_event_channel(message.channel, kPrefix));
    const auto back = decode_estimate(message.channel, message.data, kPrefix);
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(encode(back.value(), kPrefix).front().data, message.data) << message.channel;
  }
}

TEST(LcmCodec, AMetricPoseAlsoGoesOutAsThePoseThatEveryRobotReads) {
  const auto messages = encode(testing::one_of_each_estimate()[3], kPrefix);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[1].channel, "RFMVO_POSE");
  EXPECT_FALSE(is_estimate_channel("RFMVO_POSE", kPrefix));
}

TEST(LcmCodec, ATruncatedOrExtendedMessageIsAnError) {
  std::vector<LcmMessage> messages;
  for (const Event& event : testing::one_of_each_event()) messages.push_back(encode(event, kPrefix));
  for (const Estimate& estimate : testing::one_of_each_estimate())
    messages.push_back(encode(estimate, kPrefix).front());
  for (LcmMessage& message : messages) {
    const auto fails = [&](std::span<const std::uint8_t> data) {
      return is_event_channel(message.channel, kPrefix) ? !decode_event(message.channel, data, kPrefix).ok()
                                                        : !decode_estimate(message.channel, data, kPrefix).ok();
    };
    for (std::size_t size = 0; size < message.data.size(); size += 1 + size / 64)
      EXPECT_TRUE(fails(std::span(message.data).first(size))) << message.channel << " " << size;
    message.data.push_back(0);
    EXPECT_TRUE(fails(message.data)) << message.channel;
  }
}

TEST(LcmCodec, DamagedBytesNeverCrashTheDecoder) {
  std::mt19937 random(1);
  std::vector<LcmMessage> messages;
  for (const Event& event : testing::one_of_each_event()) messages.push_back(encode(event, kPrefix));
  for (const Estimate& estimate : testing::one_of_each_estimate())
    messages.push_back(encode(estimate, kPrefix).front());
  for (const LcmMessage& message : messages) {
    for (int trial = 0; trial < 300; ++trial) {
      LcmMessage damaged = message;
      const std::size_t after_hash = 8 + random() % std::min<std::size_t>(damaged.data.size() - 8, 120);
      damaged.data[after_hash] = static_cast<std::uint8_t>(random());
      if (is_event_channel(damaged.channel, kPrefix))
        (void)decode_event(damaged.channel, damaged.data, kPrefix);
      else
        (void)decode_estimate(damaged.channel, damaged.data, kPrefix);
    }
  }
}

TEST(LcmCodec, AnEpcHasOneTo62Bytes) {
  tag_read_t m = good_read();
  EXPECT_EQ(error_of_read(m), "");
  m.epc.assign(62, 7);
  m.epc_size = 62;
  EXPECT_EQ(error_of_read(m), "");
  m.epc.assign(63, 7);
  m.epc_size = 63;
  EXPECT_EQ(error_of_read(m), "RFMVO_TAG_READ: an EPC has 1 to 62 bytes, not 63");
  m.epc.clear();
  m.epc_size = 0;
  EXPECT_EQ(error_of_read(m), "RFMVO_TAG_READ: an EPC has 1 to 62 bytes, not 0");
}

TEST(LcmCodec, AHugeOrNegativeLengthFieldIsAnErrorAndAllocatesNothing) {
  for (const std::uint8_t first : {0x7f, 0xff}) {
    auto bytes = bytes_of(good_read());
    bytes[24] = first;  // most significant byte of epc_size
    const auto event = decode_event("RFMVO_TAG_READ", bytes, kPrefix);
    ASSERT_FALSE(event.ok());
    EXPECT_EQ(event.error().text(), "RFMVO_TAG_READ: not a whole rfmvo.tag_read_t message");
  }
}

// Where the length of `text` stands in the message; the text is there only once.
std::size_t length_of(const LcmMessage& message, const std::string& text) {
  const auto at = std::search(message.data.begin(), message.data.end(), text.begin(), text.end());
  EXPECT_NE(at, message.data.end()) << message.channel;
  return static_cast<std::size_t>(at - message.data.begin()) - 4;
}

TEST(LcmCodec, ATextOfAnImpossibleLengthIsAnError) {
  Health health;
  health.last_fault = "last fault";
  const LcmMessage start = encode(Event(testing::sample_start()), kPrefix);
  const LcmMessage fault = encode(Event(Fault{{}, "source", "what happened"}), kPrefix);
  const LcmMessage command = encode(Event(Command{{}, "some key", "some value"}), kPrefix);
  const LcmMessage revision = encode(Estimate(MapRevision{{}, 1, "reason"}), kPrefix).front();
  const LcmMessage healthy = encode(Estimate(health), kPrefix).front();
  const std::pair<LcmMessage, std::size_t> lengths[] = {{start, 16},                               // version
                                                        {start, length_of(start, "[estimator]")},  // configuration
                                                        {start, length_of(start, "[camera]\nm")},  // calibration
                                                        {fault, length_of(fault, "source")},
                                                        {fault, length_of(fault, "what happened")},
                                                        {command, length_of(command, "some key")},
                                                        {command, length_of(command, "some value")},
                                                        {revision, length_of(revision, "reason")},
                                                        {healthy, length_of(healthy, "last fault")}};
  for (auto [message, at] : lengths) {
    for (const std::uint32_t length : {0u, 0x80000000u, 0x80000001u, 0xffffffffu, 0x7fffffffu}) {
      for (std::size_t i = 0; i < 4; ++i) message.data[at + i] = static_cast<std::uint8_t>(length >> (24 - 8 * i));
      const std::string error = is_event_channel(message.channel, kPrefix)
                                    ? decode_event(message.channel, message.data, kPrefix).error().text()
                                    : decode_estimate(message.channel, message.data, kPrefix).error().text();
      EXPECT_THAT(error, ::testing::HasSubstr("not a whole rfmvo.")) << message.channel << " " << at << " " << length;
    }
  }
}

TEST(LcmCodec, ReadFieldsAreCheckedAgainstTheirRange) {
  tag_read_t m = good_read();
  m.port = 0;
  EXPECT_EQ(error_of_read(m), "RFMVO_TAG_READ: port 0 is out of range");
  m = good_read();
  m.phase_q16 = 65536;
  EXPECT_EQ(error_of_read(m), "RFMVO_TAG_READ: phase_q16 is out of range");
  m = good_read();
  m.frequency_hz = 0;
  EXPECT_EQ(error_of_read(m), "RFMVO_TAG_READ: frequency_hz is out of range");
}

TEST(LcmCodec, PosesAreFiniteUnitAndOfAKnownStatus) {
  camera_pose_t good{};
  good.orientation[0] = 1.0;
  const auto error = [](const camera_pose_t& m) {
    const auto event = decode_event("RFMVO_CAMERA_POSE", bytes_of(m), kPrefix);
    return event.ok() ? "" : event.error().what;
  };
  EXPECT_EQ(error(good), "");
  camera_pose_t bad = good;
  bad.pos[1] = std::nan("");
  EXPECT_EQ(error(bad), "a number is not finite");
  bad = good;
  bad.orientation[0] = 0.9;
  EXPECT_EQ(error(bad), "orientation is not a unit quaternion");
  bad = good;
  bad.status = 4;
  EXPECT_EQ(error(bad), "unknown status 4");
}

TEST(LcmCodec, CompressedFramesKeepTheirBytesAndDecodeToGrey) {
  cv::Mat image(6, 8, CV_8UC1);
  for (int i = 0; i < 48; ++i) image.data[i] = static_cast<std::uint8_t>(5 * i);
  std::vector<std::uint8_t> png;
  cv::imencode(".png", image, png);
  Frame frame;
  frame.width_px = 8;
  frame.height_px = 6;
  frame.encoding = "png";
  frame.encoded = std::make_shared<const std::vector<std::uint8_t>>(png);
  const LcmMessage message = encode(Event(frame), kPrefix);
  auto back = decode_event(message.channel, message.data, kPrefix);
  ASSERT_TRUE(back.ok()) << back.error().text();
  Frame decoded = std::get<Frame>(back.value());
  EXPECT_EQ(*decoded.encoded, png);
  EXPECT_EQ(decoded.grey, nullptr);
  ASSERT_TRUE(decode_image(decoded).ok());
  EXPECT_TRUE(std::equal(decoded.grey->begin(), decoded.grey->end(), image.data));
  EXPECT_EQ(encode(Event(decoded), kPrefix).data, message.data) << "journalled as it came";
}

TEST(LcmCodec, AnImageOfAnotherSizeThanDeclaredIsAnError) {
  std::vector<std::uint8_t> png;
  cv::imencode(".png", cv::Mat(6, 8, CV_8UC1, cv::Scalar(9)), png);
  Frame frame;
  frame.sequence = 12;
  frame.width_px = 9;
  frame.height_px = 6;
  frame.encoding = "png";
  frame.encoded = std::make_shared<const std::vector<std::uint8_t>>(png);
  const Status status = decode_image(frame);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().text(), "frame 12: the png image has 8 x 6 px, declared are 9 x 6");
}

}  // namespace
}  // namespace rfmvo
