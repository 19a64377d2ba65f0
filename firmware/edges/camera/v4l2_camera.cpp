#include "edges/camera/v4l2_camera.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace rfmvo {
namespace {

constexpr std::uint32_t kBuffers = 4;  // one with us, one being filled, two to spare
constexpr double kExposureUnit_s = 1e-4;  // of V4L2_CID_EXPOSURE_ABSOLUTE
constexpr int kReadExposureEvery = 30;    // pictures, while it is automatic: each reading is a transfer over USB

struct KnownFormat {
  PixelFormat format;
  std::uint32_t fourcc;
};
// The best first: grey as it is, planes that begin with grey, grey between colour, compressed.
constexpr std::array<KnownFormat, 5> kFormats{{{PixelFormat::kGrey, V4L2_PIX_FMT_GREY},
                                               {PixelFormat::kNv12, V4L2_PIX_FMT_NV12},
                                               {PixelFormat::kYuv420, V4L2_PIX_FMT_YUV420},
                                               {PixelFormat::kYuyv, V4L2_PIX_FMT_YUYV},
                                               {PixelFormat::kMjpeg, V4L2_PIX_FMT_MJPEG}}};

SensorClock clock_of(std::uint32_t flags) {
  // Both other types (unknown, copy) tell nothing about this machine's clocks.
  return (flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC ? SensorClock::kMonotonic
                                                                                    : SensorClock::kUnknown;
}

// uvcvideo calls "start of exposure" what is the arrival of the first packet: the picture is being read out by then.
StampInstant instant_of(std::uint32_t flags, bool uvc) {
  if (uvc) return StampInstant::kReadoutStart;
  return (flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE ? StampInstant::kExposureStart
                                                                                : StampInstant::kReadoutEnd;
}

v4l2_buffer buffer_at(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

std::string size_text(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

V4l2Camera::V4l2Camera(std::string device, OpenV4l2Node open) : device_(std::move(device)), open_(std::move(open)) {}

V4l2Camera::~V4l2Camera() { stop(); }

Error V4l2Camera::trouble(const std::string& what, int error) const {
  if (error == ENODEV) return {ErrorCode::kNotFound, "the camera is gone", device_};
  const bool busy = error == EBUSY;
  return {ErrorCode::kUnreadable, what + ": " + (busy ? "another program uses it" : std::strerror(error)), device_};
}

Result<CameraMode> V4l2Camera::start(const CameraConfig& config) {
  stop();
  auto opened = open_(device_);
  if (!opened) return opened.error();
  node_ = std::move(opened).value();
  v4l2_capability capability{};
  if (const int error = node_->control(VIDIOC_QUERYCAP, &capability); error != 0)
    return Error{ErrorCode::kUnsupported, "not a V4L2 device: " + std::string(std::strerror(error)), device_};
  const std::uint32_t can =
      (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0)
    return Error{ErrorCode::kUnsupported, "takes no pictures by streaming in single-planar formats", device_};
  uvc_ = std::strncmp(reinterpret_cast<const char*>(capability.driver), "uvcvideo", sizeof(capability.driver)) == 0;
  if (const Status s = choose_format(config); !s) return s.error();
  CameraMode mode;
  mode.format = format_;
  set_rate(config, mode);
  for (std::string& note : adjust(config)) mode.notes.push_back(std::move(note));
  if (const Status s = start_streaming(); !s) return s.error();
  const auto* card = reinterpret_cast<const char*>(capability.card);
  mode.text = std::string(card, ::strnlen(card, sizeof(capability.card))) + " at " + device_ + ", " +
              size_text(static_cast<std::uint32_t>(width_px_), static_cast<std::uint32_t>(height_px_)) + " " +
              std::string(name_of(format_)) + mode.text;
  return mode;
}

Status V4l2Camera::choose_format(const CameraConfig& config) {
  std::vector<std::uint32_t> offered;
  v4l2_fmtdesc description{};
  description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  constexpr std::uint32_t kMost = 256;
  for (; description.index < kMost && node_->control(VIDIOC_ENUM_FMT, &description) == 0; ++description.index)
    offered.push_back(description.pixelformat);
  std::string names;
  for (const KnownFormat& known : kFormats) {
    if (std::find(offered.begin(), offered.end(), known.fourcc) == offered.end()) continue;
    names += (names.empty() ? "" : ", ") + std::string(name_of(known.format));
    if (config.format != "auto" && config.format != name_of(known.format)) continue;
    format_ = known.format;
    return set_format(config, known.fourcc);
  }
  if (names.empty()) return Error{ErrorCode::kUnsupported, "has none of grey, nv12, yuv420, yuyv, mjpg", device_};
  return Error{ErrorCode::kUnsupported, "has no \"" + config.format + "\", but " + names, device_};
}

Status V4l2Camera::set_format(const CameraConfig& config, std::uint32_t fourcc) {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = static_cast<std::uint32_t>(config.width_px);
  format.fmt.pix.height = static_cast<std::uint32_t>(config.height_px);
  format.fmt.pix.pixelformat = fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  if (const int error = node_->control(VIDIOC_S_FMT, &format); error != 0) return trouble("refuses the format", error);
  const v4l2_pix_format& got = format.fmt.pix;
  // The calibration is of one size.
  if (got.width != config.width_px || got.height != config.height_px || got.pixelformat != fourcc)
    return Error{ErrorCode::kUnsupported,
                 "gives " + size_text(got.width, got.height) + " instead of " +
                     size_text(static_cast<std::uint32_t>(config.width_px), static_cast<std::uint32_t>(config.height_px)) +
                     " px of " + std::string(name_of(format_)),
                 device_};
  width_px_ = static_cast<int>(got.width);
  height_px_ = static_cast<int>(got.height);
  const std::size_t row = got.width * (format_ == PixelFormat::kYuyv ? std::size_t{2} : std::size_t{1});
  stride_bytes_ = std::max<std::size_t>(got.bytesperline, row);
  return Done{};
}

void V4l2Camera::set_rate(const CameraConfig& config, CameraMode& mode) {
  if (config.frame_rate_hz == 0.0) return;
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  constexpr double kResolution = 1000.0;
  parameters.parm.capture.timeperframe = {static_cast<std::uint32_t>(kResolution),
                                          static_cast<std::uint32_t>(std::lround(config.frame_rate_hz * kResolution))};
  const auto refused = [&](const std::string& text) { mode.notes.push_back(device_ + ": " + text); };
  if (node_->control(VIDIOC_S_PARM, &parameters) != 0 ||
      (parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) == 0)
    return refused("has no control of its frame rate");
  const v4l2_fract& period = parameters.parm.capture.timeperframe;
  if (period.numerator == 0) return;
  const double rate_hz = static_cast<double>(period.denominator) / period.numerator;
  const std::string text = std::to_string(std::lround(rate_hz)) + " frames/s";
  mode.text = ", " + text;
  constexpr double kMuch = 0.05;  // drivers know only some rates
  if (std::abs(rate_hz - config.frame_rate_hz) > kMuch * config.frame_rate_hz) refused("gives " + text);
}

bool V4l2Camera::set_control(std::uint32_t id, std::int64_t value) {
  v4l2_control control{id, static_cast<std::int32_t>(value)};
  return node_->control(VIDIOC_S_CTRL, &control) == 0;
}

std::optional<std::int64_t> V4l2Camera::get_control(std::uint32_t id) {
  v4l2_control control{id, 0};
  if (node_->control(VIDIOC_G_CTRL, &control) != 0) return std::nullopt;
  return control.value;
}

std::vector<std::string> V4l2Camera::adjust(const CameraConfig& config) {
  std::vector<std::string> notes;
  const bool manual = config.exposure_s > 0.0;
  const bool chosen = manual ? set_control(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL)
                             : set_control(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_AUTO) ||
                                   set_control(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY);
  const auto units = std::max(std::llround(config.exposure_s / kExposureUnit_s), 1LL);
  if (manual && (!set_control(V4L2_CID_EXPOSURE_ABSOLUTE, units) && !chosen))
    notes.push_back(device_ + ": has no control of its exposure");
  const bool gain_set = config.gain > 0.0 ? set_control(V4L2_CID_ANALOGUE_GAIN, std::llround(config.gain)) ||
                                                set_control(V4L2_CID_GAIN, std::llround(config.gain))
                                          : true;
  if (!gain_set) notes.push_back(device_ + ": has no control of its gain");
  automatic_exposure_ = !manual;
  read_exposure();
  return notes;
}

void V4l2Camera::read_exposure() {
  const auto set = get_control(V4L2_CID_EXPOSURE_ABSOLUTE);
  exposure_ = set && *set > 0 ? std::optional(Duration::from_seconds(static_cast<double>(*set) * kExposureUnit_s))
                              : std::nullopt;
}

Status V4l2Camera::queue(std::uint32_t index) {
  v4l2_buffer buffer = buffer_at(index);
  if (const int error = node_->control(VIDIOC_QBUF, &buffer); error != 0) return trouble("takes no buffer", error);
  return Done{};
}

Status V4l2Camera::start_streaming() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = node_->control(VIDIOC_REQBUFS, &request); error != 0) return trouble("gives no buffers", error);
  if (request.count < 2) return Error{ErrorCode::kUnsupported, "has memory for one picture only", device_};
  for (std::uint32_t index = 0; index < request.count; ++index) {
    v4l2_buffer buffer = buffer_at(index);
    if (const int error = node_->control(VIDIOC_QUERYBUF, &buffer); error != 0) return trouble("loses a buffer", error);
    const std::uint8_t* start = node_->map(buffer.length, buffer.m.offset);
    if (start == nullptr) return Error{ErrorCode::kUnreadable, "its memory cannot be mapped", device_};
    buffers_.push_back({start, buffer.length});
    if (const Status s = queue(index); !s) return s;
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int error = node_->control(VIDIOC_STREAMON, &type); error != 0) return trouble("does not start", error);
  streaming_ = true;
  return Done{};
}

Result<std::optional<CapturedImage>> V4l2Camera::next(Duration wait) {
  RFMVO_ASSERT(streaming_);
  if (lent_) {
    const std::uint32_t index = *lent_;
    lent_.reset();
    if (const Status s = queue(index); !s) return s.error();
  }
  if (!node_->wait(wait)) return std::optional<CapturedImage>();
  v4l2_buffer buffer = buffer_at(0);
  const int error = node_->control(VIDIOC_DQBUF, &buffer);
  if (error == EAGAIN) return std::optional<CapturedImage>();
  if (error != 0) return trouble("gives no picture", error);
  if (buffer.index >= buffers_.size())
    return Error{ErrorCode::kMalformed, "its driver names a buffer that does not exist", device_};
  lent_ = buffer.index;
  if (automatic_exposure_ && ++pictures_ % kReadExposureEvery == 0) read_exposure();
  CapturedImage image;
  image.format = format_;
  image.width_px = width_px_;
  image.height_px = height_px_;
  image.stride_bytes = stride_bytes_;
  const Buffer& memory = buffers_[buffer.index];
  image.bytes = {memory.start, std::min<std::size_t>(buffer.bytesused, memory.bytes)};
  image.stamp = {clock_of(buffer.flags), instant_of(buffer.flags, uvc_),
                 buffer.timestamp.tv_sec * std::int64_t{1'000'000'000} + buffer.timestamp.tv_usec * std::int64_t{1000}};
  image.sequence = buffer.sequence;
  image.exposure = exposure_;
  image.damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
  return std::optional(image);
}

void V4l2Camera::stop() {
  if (node_ == nullptr) return;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (streaming_) (void)node_->control(VIDIOC_STREAMOFF, &type);
  for (const Buffer& buffer : buffers_) node_->unmap(buffer.start, buffer.bytes);
  buffers_.clear();
  lent_.reset();
  streaming_ = false;
  node_.reset();
}

}  // namespace rfmvo
