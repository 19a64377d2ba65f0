#include "edges/camera/libcamera_camera.hpp"

#include <libcamera/libcamera.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

namespace rfmvo {
namespace {

namespace lc = libcamera;

constexpr unsigned kBuffers = 4;

struct KnownFormat {
  PixelFormat format;
  const char* name;
};
constexpr std::array<KnownFormat, 5> kFormats{{{PixelFormat::kGrey, "R8"},
                                               {PixelFormat::kNv12, "NV12"},
                                               {PixelFormat::kYuv420, "YUV420"},
                                               {PixelFormat::kYuyv, "YUYV"},
                                               {PixelFormat::kMjpeg, "MJPEG"}}};

// Planes may share one file; each file is mapped once.
class Mappings {
 public:
  Mappings() = default;
  ~Mappings() {
    for (const auto& [fd, mapped] : maps_) (void)::munmap(mapped.first, mapped.second);
  }
  Mappings(const Mappings&) = delete;
  Mappings& operator=(const Mappings&) = delete;

  [[nodiscard]] bool add(const lc::FrameBuffer& buffer) {
    const int fd = buffer.planes()[0].fd.get();
    if (maps_.count(fd) != 0) return true;
    const off_t end = ::lseek(fd, 0, SEEK_END);
    std::size_t bytes = end > 0 ? static_cast<std::size_t>(end) : 0;
    for (const auto& plane : buffer.planes())
      if (plane.fd.get() == fd) bytes = std::max<std::size_t>(bytes, plane.offset + plane.length);
    void* start = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd, 0);
    if (start == MAP_FAILED) return false;
    maps_[fd] = {start, bytes};
    return true;
  }
  // The first plane, and whatever follows it in the same file.
  [[nodiscard]] std::span<const std::uint8_t> bytes_of(const lc::FrameBuffer& buffer) const {
    const auto& plane = buffer.planes()[0];
    const auto& [start, bytes] = maps_.at(plane.fd.get());
    const std::size_t offset = std::min<std::size_t>(plane.offset, bytes);
    return {static_cast<const std::uint8_t*>(start) + offset, bytes - offset};
  }

 private:
  std::map<int, std::pair<void*, std::size_t>> maps_;
};

}  // namespace

struct LibcameraCamera::Session {
  lc::CameraManager manager;  // first in, last out
  std::shared_ptr<lc::Camera> camera;
  bool acquired = false, running = false;
  std::unique_ptr<lc::CameraConfiguration> configuration;
  std::unique_ptr<lc::FrameBufferAllocator> allocator;
  std::unique_ptr<Mappings> mappings;
  std::vector<std::unique_ptr<lc::Request>> requests;
  lc::Request* lent = nullptr;  // the one behind the last picture
  PixelFormat format = PixelFormat::kGrey;
  std::optional<CameraConfig> adjustment;  // goes out with the next request

  std::mutex mutex;  // what libcamera's own thread touches
  std::condition_variable changed;
  std::deque<lc::Request*> done;
  bool gone = false;

  ~Session();
  void on_completed(lc::Request* request);
  void on_disconnected();
  [[nodiscard]] Status open(const std::string& id);
  [[nodiscard]] Status configure(const CameraConfig& config, const std::string& name);
  [[nodiscard]] Status allocate(const std::string& name);
  [[nodiscard]] Status run(const CameraConfig& config, const std::string& name);
  [[nodiscard]] std::vector<std::string> put_controls(const CameraConfig& config, lc::ControlList& list) const;
  [[nodiscard]] bool has(const lc::ControlId& control) const { return camera->controls().count(&control) != 0; }
  [[nodiscard]] CapturedImage image_of(const lc::Request& request) const;
};

LibcameraCamera::Session::~Session() {
  if (running) (void)camera->stop();
  if (camera != nullptr) {
    camera->requestCompleted.disconnect(this);
    camera->disconnected.disconnect(this);
  }
  requests.clear();
  mappings.reset();
  if (allocator != nullptr && configuration != nullptr) (void)allocator->free(configuration->at(0).stream());
  allocator.reset();
  if (acquired) (void)camera->release();
  configuration.reset();
  camera.reset();
  manager.stop();
}

void LibcameraCamera::Session::on_completed(lc::Request* request) {
  if (request->status() == lc::Request::RequestCancelled) return;
  const std::lock_guard lock(mutex);
  done.push_back(request);
  changed.notify_one();
}

void LibcameraCamera::Session::on_disconnected() {
  const std::lock_guard lock(mutex);
  gone = true;
  changed.notify_one();
}

Status LibcameraCamera::Session::open(const std::string& id) {
  if (manager.start() != 0) return Error{ErrorCode::kUnsupported, "cannot be used on this machine", "libcamera"};
  const auto cameras = manager.cameras();
  if (cameras.empty()) return Error{ErrorCode::kNotFound, "finds no camera", "libcamera"};
  std::string known;
  for (const auto& candidate : cameras) {
    known += (known.empty() ? "" : ", ") + candidate->id();
    if (id.empty() || candidate->id() == id) {
      camera = candidate;
      break;
    }
  }
  if (camera == nullptr) return Error{ErrorCode::kNotFound, "no such camera; libcamera finds " + known, id};
  acquired = camera->acquire() == 0;
  if (!acquired) return Error{ErrorCode::kUnreadable, "another program uses it", camera->id()};
  camera->requestCompleted.connect(this, &Session::on_completed);
  camera->disconnected.connect(this, &Session::on_disconnected);
  return Done{};
}

Status LibcameraCamera::Session::configure(const CameraConfig& config, const std::string& name) {
  configuration = camera->generateConfiguration({lc::StreamRole::VideoRecording});
  if (configuration == nullptr) configuration = camera->generateConfiguration({lc::StreamRole::Viewfinder});
  if (configuration == nullptr) return Error{ErrorCode::kUnsupported, "takes no video", name};
  lc::StreamConfiguration& stream = configuration->at(0);
  const auto offered = stream.formats().pixelformats();
  std::string names;
  std::optional<KnownFormat> chosen;
  for (const KnownFormat& candidate : kFormats) {
    if (std::find(offered.begin(), offered.end(), lc::PixelFormat::fromString(candidate.name)) == offered.end()) continue;
    names += (names.empty() ? "" : ", ") + std::string(name_of(candidate.format));
    if (!chosen && (config.format == "auto" || config.format == name_of(candidate.format))) chosen = candidate;
  }
  if (!chosen) return Error{ErrorCode::kUnsupported, "has no \"" + config.format + "\", but: " + names, name};
  format = chosen->format;
  const lc::Size size(static_cast<unsigned>(config.width_px), static_cast<unsigned>(config.height_px));
  stream.size = size;
  stream.pixelFormat = lc::PixelFormat::fromString(chosen->name);
  stream.bufferCount = kBuffers;
  const bool invalid = configuration->validate() == lc::CameraConfiguration::Invalid;
  // The calibration is of one size.
  if (invalid || stream.size != size || stream.pixelFormat != lc::PixelFormat::fromString(chosen->name))
    return Error{ErrorCode::kUnsupported, "gives " + stream.toString() + " instead of " + size.toString() + " px", name};
  if (camera->configure(configuration.get()) != 0) return Error{ErrorCode::kUnsupported, "refuses the format", name};
  return Done{};
}

Status LibcameraCamera::Session::allocate(const std::string& name) {
  lc::Stream* stream = configuration->at(0).stream();
  allocator = std::make_unique<lc::FrameBufferAllocator>(camera);
  mappings = std::make_unique<Mappings>();
  if (allocator->allocate(stream) < 0) return Error{ErrorCode::kUnreadable, "gives no buffers", name};
  for (const auto& buffer : allocator->buffers(stream)) {
    if (buffer->planes().empty() || !mappings->add(*buffer))
      return Error{ErrorCode::kUnreadable, "its memory cannot be mapped", name};
    auto request = camera->createRequest();
    if (request == nullptr || request->addBuffer(stream, buffer.get()) != 0)
      return Error{ErrorCode::kUnreadable, "takes no buffer", name};
    requests.push_back(std::move(request));
  }
  return Done{};
}

std::vector<std::string> LibcameraCamera::Session::put_controls(const CameraConfig& config,
                                                                lc::ControlList& list) const {
  std::vector<std::string> notes;
  const auto note = [&](const std::string& what) { notes.push_back(camera->id() + ": has no control of its " + what); };
  const bool manual = config.exposure_s > 0.0;
  if (has(lc::controls::AeEnable)) list.set(lc::controls::AeEnable, !manual);
  if (manual && has(lc::controls::ExposureTime))
    list.set(lc::controls::ExposureTime, static_cast<std::int32_t>(Duration::from_seconds(config.exposure_s).ns / 1000));
  else if (manual)
    note("exposure");
  if (config.gain > 0.0 && has(lc::controls::AnalogueGain))
    list.set(lc::controls::AnalogueGain, static_cast<float>(config.gain));
  else if (config.gain > 0.0)
    note("gain");
  if (config.frame_rate_hz > 0.0 && has(lc::controls::FrameDurationLimits)) {
    const auto period_us = static_cast<std::int64_t>(1e6 / config.frame_rate_hz);
    list.set(lc::controls::FrameDurationLimits, lc::Span<const std::int64_t, 2>({period_us, period_us}));
  } else if (config.frame_rate_hz > 0.0) {
    note("frame rate");
  }
  return notes;
}

Status LibcameraCamera::Session::run(const CameraConfig& config, const std::string& name) {
  lc::ControlList initial(camera->controls());
  (void)put_controls(config, initial);
  if (camera->start(&initial) != 0) return Error{ErrorCode::kUnreadable, "does not start", name};
  running = true;
  // Some handlers ignore what start() was given (uvcvideo before 0.5).
  (void)put_controls(config, requests.front()->controls());
  for (const auto& request : requests)
    if (camera->queueRequest(request.get()) != 0) return Error{ErrorCode::kUnreadable, "takes no request", name};
  return Done{};
}

CapturedImage LibcameraCamera::Session::image_of(const lc::Request& request) const {
  const lc::FrameBuffer& buffer = *request.buffers().begin()->second;
  const lc::StreamConfiguration& stream = configuration->at(0);
  // Not a const function before 0.7.
  const lc::ControlList& metadata = const_cast<lc::Request&>(request).metadata();
  CapturedImage image;
  image.format = format;
  image.width_px = static_cast<int>(stream.size.width);
  image.height_px = static_cast<int>(stream.size.height);
  image.stride_bytes = stream.stride;
  image.bytes = mappings->bytes_of(buffer);
  if (format == PixelFormat::kMjpeg)
    image.bytes = image.bytes.first(std::min<std::size_t>(image.bytes.size(), buffer.metadata().planes()[0].bytesused));
  // Documented as the first row's exposure; the receivers of the Pi and uvcvideo read their clock when the first row
  // arrives, which is when its exposure is over.
  const auto stamp = metadata.get(lc::controls::SensorTimestamp);
  image.stamp.instant = StampInstant::kReadoutStart;
  image.stamp.clock = stamp ? SensorClock::kBoottime : SensorClock::kMonotonic;
  image.stamp.ns = stamp ? *stamp : static_cast<std::int64_t>(buffer.metadata().timestamp);
  image.sequence = buffer.metadata().sequence;
  if (const auto exposure_us = metadata.get(lc::controls::ExposureTime); exposure_us && *exposure_us > 0)
    image.exposure = Duration{std::int64_t{*exposure_us} * 1000};
  image.damaged = buffer.metadata().status != lc::FrameMetadata::FrameSuccess;
  return image;
}

LibcameraCamera::LibcameraCamera(std::string id) : id_(std::move(id)) {}
LibcameraCamera::~LibcameraCamera() = default;

Result<CameraMode> LibcameraCamera::start(const CameraConfig& config) {
  stop();
  auto session = std::make_unique<Session>();
  if (const Status s = session->open(id_); !s) return s.error();
  const std::string name = session->camera->id();
  if (const Status s = session->configure(config, name); !s) return s.error();
  if (const Status s = session->allocate(name); !s) return s.error();
  if (const Status s = session->run(config, name); !s) return s.error();
  CameraMode mode;
  mode.format = session->format;
  mode.text = name + ", " + session->configuration->at(0).toString();
  lc::ControlList asked(session->camera->controls());
  mode.notes = session->put_controls(config, asked);
  session_ = std::move(session);
  return mode;
}

Result<std::optional<CapturedImage>> LibcameraCamera::next(Duration wait) {
  RFMVO_ASSERT(session_ != nullptr);
  Session& s = *session_;
  if (s.lent != nullptr) {
    s.lent->reuse(lc::Request::ReuseBuffers);
    if (s.adjustment) (void)s.put_controls(*s.adjustment, s.lent->controls());
    s.adjustment.reset();
    const bool queued = s.camera->queueRequest(s.lent) == 0;
    s.lent = nullptr;
    if (!queued) return Error{ErrorCode::kNotFound, "the camera is gone", s.camera->id()};
  }
  std::unique_lock lock(s.mutex);
  s.changed.wait_for(lock, std::chrono::nanoseconds(wait.ns), [&] { return s.gone || !s.done.empty(); });
  if (s.gone) return Error{ErrorCode::kNotFound, "the camera is gone", s.camera->id()};
  if (s.done.empty()) return std::optional<CapturedImage>();
  s.lent = s.done.front();
  s.done.pop_front();
  return std::optional(s.image_of(*s.lent));
}

std::vector<std::string> LibcameraCamera::adjust(const CameraConfig& config) {
  if (session_ == nullptr) return {};
  session_->adjustment = config;
  lc::ControlList asked(session_->camera->controls());
  return session_->put_controls(config, asked);
}

void LibcameraCamera::stop() { session_.reset(); }

}  // namespace rfmvo
