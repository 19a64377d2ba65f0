#include <opencv2/imgcodecs.hpp>

#include "edges/lcm_codec.hpp"
#include "edges/lcm_codec_parts.hpp"
#include "edges/toml_files.hpp"
#include "rfmvo/command_t.hpp"
#include "rfmvo/fault_t.hpp"
#include "rfmvo/frame_t.hpp"
#include "rfmvo/start_t.hpp"
#include "rfmvo/tag_read_t.hpp"
#include "rfmvo/tick_t.hpp"

namespace rfmvo {
namespace {

using namespace codec;

constexpr int kMaxImageSide_px = 16384;
constexpr std::size_t kMaxImageBytes = std::size_t{1} << 27;  // 128 MB: 16 times a 4K grey frame
constexpr std::size_t kMaxTomlBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxStringBytes = std::size_t{1} << 16;
constexpr std::size_t kHashBytes = 8;  // fingerprint in front of every LCM message

LcmMessage encode_one(const Start& start, std::string_view prefix) {
  start_t m;
  m.utime = start.time.us();
  m.version = RFMVO_VERSION;
  m.config_toml = to_toml(start.config);
  m.calibration_toml = to_toml(start.calibration);
  return pack(m, prefix, "START");
}

LcmMessage encode_one(const Frame& frame, std::string_view prefix) {
  frame_t m;
  m.utime = frame.time.us();
  m.sequence = frame.sequence;
  m.width = frame.width_px;
  m.height = frame.height_px;
  const bool compressed = frame.encoded != nullptr;
  RFMVO_ASSERT(compressed || frame.grey != nullptr);
  m.encoding = compressed ? frame.encoding : "grey8";
  m.data = compressed ? *frame.encoded : *frame.grey;
  RFMVO_ASSERT(m.data.size() <= kMaxImageBytes);
  m.size = static_cast<std::int32_t>(m.data.size());
  return pack(m, prefix, "FRAME");
}

LcmMessage encode_one(const CameraPose& pose, std::string_view prefix) {
  return pack(message_of(pose), prefix, "CAMERA_POSE");
}

LcmMessage encode_one(const TagRead& read, std::string_view prefix) {
  tag_read_t m;
  m.utime = read.time.us();
  m.reader_utime = read.reader_time.us();
  m.epc.assign(read.epc.bytes().begin(), read.epc.bytes().end());
  m.epc_size = static_cast<std::int32_t>(m.epc.size());
  m.port = read.port;
  m.phase_q16 = read.phase.turn_q16;
  m.frequency_hz = static_cast<std::int32_t>(read.frequency_hz);
  m.rssi_cdbm = read.rssi_cdbm;
  m.seen_count = read.seen_count;
  m.doppler_hz_q4 = read.doppler_hz_q4;
  return pack(m, prefix, "TAG_READ");
}

LcmMessage encode_one(const Tick& tick, std::string_view prefix) {
  tick_t m;
  m.utime = tick.time.us();
  return pack(m, prefix, "TICK");
}

// LCM strings end at a NUL and readers expect bounded lengths.
std::string bounded(const std::string& text) { return std::string(text.substr(0, kMaxStringBytes).c_str()); }

LcmMessage encode_one(const Fault& fault, std::string_view prefix) {
  fault_t m;
  m.utime = fault.time.us();
  m.source = bounded(fault.source);
  m.text = bounded(fault.text);
  return pack(m, prefix, "FAULT");
}

LcmMessage encode_one(const ReaderStatus& status, std::string_view prefix) {
  return pack(message_of(status), prefix, "READER_STATUS");
}

LcmMessage encode_one(const Command& command, std::string_view prefix) {
  command_t m;
  m.utime = command.time.us();
  m.key = bounded(command.key);
  m.value = bounded(command.value);
  return pack(m, prefix, "COMMAND");
}

using Bytes = std::span<const std::uint8_t>;

Result<Event> decode_start(std::string_view channel, Bytes data) {
  start_t m;
  if (const Status s = unpack(m, data, channel, {kHashBytes + 8, 3}); !s) return s.error();
  if (m.config_toml.size() > kMaxTomlBytes || m.calibration_toml.size() > kMaxTomlBytes)
    return malformed("configuration text is too long", channel);
  auto config = parse_config(m.config_toml, std::string(channel) + " configuration");
  if (!config) return config.error();
  auto calibration = parse_calibration(m.calibration_toml, std::string(channel) + " calibration");
  if (!calibration) return calibration.error();
  return Event(Start{DeviceTime::from_us(m.utime), std::move(config).value(), std::move(calibration).value()});
}

Result<Event> decode_frame(std::string_view channel, Bytes data) {
  constexpr std::size_t kEncodingOffset = kHashBytes + 8 + 8 + 4 + 4;
  const std::int64_t encoding_bytes = peek_int32(data, kEncodingOffset);
  if (encoding_bytes < 1 || encoding_bytes > 16 ||
      !holds_array(data, kEncodingOffset + 4 + static_cast<std::size_t>(encoding_bytes), 1))
    return malformed("not a whole rfmvo.frame_t message", channel);
  frame_t m;
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  if (m.width < 1 || m.height < 1 || m.width > kMaxImageSide_px || m.height > kMaxImageSide_px)
    return malformed("image size " + std::to_string(m.width) + " x " + std::to_string(m.height) + " is out of range",
                     channel);
  if (m.data.size() > kMaxImageBytes) return malformed("image data is too long", channel);
  Frame frame;
  frame.time = DeviceTime::from_us(m.utime);
  frame.sequence = m.sequence;
  frame.width_px = m.width;
  frame.height_px = m.height;
  frame.encoding = m.encoding;
  const std::size_t pixels = static_cast<std::size_t>(m.width) * static_cast<std::size_t>(m.height);
  const std::size_t size = m.data.size();
  auto bytes = std::make_shared<const std::vector<std::uint8_t>>(std::move(m.data));
  if (m.encoding == "grey8") {
    if (size != pixels)
      return malformed(std::to_string(size) + " bytes are not width * height = " + std::to_string(pixels), channel);
    frame.grey = std::move(bytes);
  } else if (m.encoding == "jpeg" || m.encoding == "png") {
    if (size == 0) return malformed("image data is empty", channel);
    frame.encoded = std::move(bytes);
  } else {
    return malformed("unknown image encoding \"" + m.encoding + "\"; known: grey8, jpeg, png", channel);
  }
  return Event(std::move(frame));
}

Result<Event> decode_camera_pose(std::string_view channel, Bytes data) {
  camera_pose_t m;
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  auto pose = camera_pose_of(m, channel);
  if (!pose) return pose.error();
  return Event(std::move(pose).value());
}

Result<Event> decode_tag_read(std::string_view channel, Bytes data) {
  if (!holds_array(data, kHashBytes + 8 + 8, 1)) return malformed("not a whole rfmvo.tag_read_t message", channel);
  tag_read_t m;
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  auto epc = Epc::from_bytes({reinterpret_cast<const std::uint8_t*>(m.epc.data()), m.epc.size()});
  if (!epc) return malformed(epc.error().what, channel);
  if (m.reader_utime > kMaxUtime || m.reader_utime < -kMaxUtime)
    return malformed("reader_utime is out of range", channel);
  if (m.port < 1 || !fits<std::uint8_t>(m.port))
    return malformed("port " + std::to_string(m.port) + " is out of range", channel);
  if (!fits<std::uint16_t>(m.phase_q16)) return malformed("phase_q16 is out of range", channel);
  if (m.frequency_hz <= 0) return malformed("frequency_hz is out of range", channel);
  if (m.rssi_cdbm < std::numeric_limits<std::int16_t>::min() || m.rssi_cdbm > std::numeric_limits<std::int16_t>::max())
    return malformed("rssi_cdbm is out of range", channel);
  if (!fits<std::uint16_t>(m.seen_count)) return malformed("seen_count is out of range", channel);
  if (m.doppler_hz_q4 < std::numeric_limits<std::int16_t>::min() ||
      m.doppler_hz_q4 > std::numeric_limits<std::int16_t>::max())
    return malformed("doppler_hz_q4 is out of range", channel);
  TagRead read;
  read.time = DeviceTime::from_us(m.utime);
  read.reader_time = ReaderTime::from_us(m.reader_utime);
  read.epc = epc.value();
  read.port = static_cast<std::uint8_t>(m.port);
  read.phase = {static_cast<std::uint16_t>(m.phase_q16)};
  read.frequency_hz = static_cast<std::uint32_t>(m.frequency_hz);
  read.rssi_cdbm = static_cast<std::int16_t>(m.rssi_cdbm);
  read.seen_count = static_cast<std::uint16_t>(m.seen_count);
  read.doppler_hz_q4 = static_cast<std::int16_t>(m.doppler_hz_q4);
  return Event(read);
}

Result<Event> decode_tick(std::string_view channel, Bytes data) {
  tick_t m;
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  return Event(Tick{DeviceTime::from_us(m.utime)});
}

Result<Event> decode_fault(std::string_view channel, Bytes data) {
  fault_t m;
  if (const Status s = unpack(m, data, channel, {kHashBytes + 8, 2}); !s) return s.error();
  if (m.source.size() > kMaxStringBytes || m.text.size() > kMaxStringBytes)
    return malformed("a text is too long", channel);
  return Event(Fault{DeviceTime::from_us(m.utime), std::move(m.source), std::move(m.text)});
}

Result<Event> decode_command(std::string_view channel, Bytes data) {
  command_t m;
  if (const Status s = unpack(m, data, channel, {kHashBytes + 8, 2}); !s) return s.error();
  if (m.key.size() > kMaxStringBytes || m.value.size() > kMaxStringBytes)
    return malformed("a text is too long", channel);
  return Event(Command{DeviceTime::from_us(m.utime), std::move(m.key), std::move(m.value)});
}

Result<Event> decode_reader_status(std::string_view channel, Bytes data) {
  reader_status_t m;
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  auto status = reader_status_of(m, channel);
  if (!status) return status.error();
  return Event(status.value());
}

struct EventChannel {
  std::string_view name;
  Result<Event> (*decode)(std::string_view channel, Bytes data);
};

constexpr EventChannel kEventChannels[] = {
    {"START", decode_start},
    {"FRAME", decode_frame},
    {"CAMERA_POSE", decode_camera_pose},
    {"TAG_READ", decode_tag_read},
    {"TICK", decode_tick},
    {"FAULT", decode_fault},
    {"COMMAND", decode_command},
    {"READER_STATUS", decode_reader_status},
};

const EventChannel* find_channel(std::string_view channel, std::string_view prefix) {
  if (!channel.starts_with(prefix)) return nullptr;
  for (const EventChannel& c : kEventChannels)
    if (c.name == channel.substr(prefix.size())) return &c;
  return nullptr;
}

}  // namespace

LcmMessage encode(const Event& event, std::string_view prefix) {
  return std::visit([prefix](const auto& e) { return encode_one(e, prefix); }, event);
}

bool is_event_channel(std::string_view channel, std::string_view prefix) {
  return find_channel(channel, prefix) != nullptr;
}

Result<Event> decode_event(std::string_view channel, Bytes data, std::string_view prefix) {
  const EventChannel* found = find_channel(channel, prefix);
  if (found == nullptr) return malformed("not a channel of events", channel);
  return found->decode(channel, data);
}

Status decode_image(Frame& frame) {
  if (frame.grey != nullptr) return Done{};
  const std::string where = "frame " + std::to_string(frame.sequence);
  if (frame.encoded == nullptr || frame.encoded->empty()) return malformed("the frame has no image", where);
  cv::Mat image;
  try {
    image = cv::imdecode(*frame.encoded, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) return malformed("the " + frame.encoding + " image cannot be decoded", where);
  if (image.cols != frame.width_px || image.rows != frame.height_px)
    return malformed("the " + frame.encoding + " image has " + std::to_string(image.cols) + " x " +
                         std::to_string(image.rows) + " px, declared are " + std::to_string(frame.width_px) + " x " +
                         std::to_string(frame.height_px),
                     where);
  auto grey = std::make_shared<std::vector<std::uint8_t>>();
  grey->reserve(image.total());
  for (int row = 0; row < image.rows; ++row) grey->insert(grey->end(), image.ptr(row), image.ptr(row) + image.cols);
  frame.grey = std::move(grey);
  return Done{};
}

}  // namespace rfmvo
