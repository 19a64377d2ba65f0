#include "edges/camera/camera_source.hpp"

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "edges/lcm_codec.hpp"

namespace rfmvo {
namespace {

constexpr Duration kLook{50'000'000};               // how long one look for a picture may take
constexpr Duration kReadOffsetsEvery{1'000'000'000};
constexpr Duration kTellLostEvery{1'000'000'000};

ShutterTiming shutter_of(const Config& config, const ImageWindow& window) {
  ShutterTiming shutter;
  shutter.exposure = Duration::from_seconds(config.camera.exposure_s);
  // vision.readout_s is that of the used picture; negative if it is upside down. The sensor reads the whole one.
  const auto whole_px = static_cast<double>(config.camera.height_px);
  shutter.readout = Duration::from_seconds(std::abs(config.vision.readout_s) * whole_px / window.height_px);
  shutter.row_share = (window.y_px + 0.5 * window.height_px) / whole_px;
  return shutter;
}

// The estimator must see what the journal holds: a lossy picture is decoded again.
Status compress(Frame& frame, int quality) {
  const cv::Mat image(frame.height_px, frame.width_px, CV_8UC1, const_cast<std::uint8_t*>(frame.grey->data()));
  auto jpeg = std::make_shared<std::vector<std::uint8_t>>();
  if (!cv::imencode(".jpg", image, *jpeg, {cv::IMWRITE_JPEG_QUALITY, quality}))
    return Error{ErrorCode::kUnsupported, "cannot be written as JPEG", "camera"};
  frame.encoding = "jpeg";
  frame.encoded = std::move(jpeg);
  frame.grey = nullptr;
  return decode_image(frame);
}

}  // namespace

CameraSource::CameraSource(Parts parts, const Config& config, const std::atomic<bool>& stop)
    : parts_(std::move(parts)),
      config_(config.camera),
      journal_(config.journal),
      window_(window_of(config.camera)),
      shutter_(shutter_of(config, window_)),
      stop_(stop),
      policy_(Duration::from_seconds(config.camera.stall_s), parts_.clock()) {}

CameraSource::~CameraSource() { parts_.device->stop(); }

void CameraSource::adjust(double exposure_s, double gain) {
  const std::lock_guard lock(adjust_mutex_);
  if (!adjustment_) adjustment_ = CameraConfig{};
  adjustment_->exposure_s = exposure_s;
  adjustment_->gain = gain;
}

void CameraSource::take_adjustment(DeviceTime now) {
  {
    const std::lock_guard lock(adjust_mutex_);
    if (!adjustment_) return;
    config_.exposure_s = adjustment_->exposure_s;
    config_.gain = adjustment_->gain;
    adjustment_.reset();
  }
  shutter_.exposure = Duration::from_seconds(config_.exposure_s);
  if (!running_) return;
  for (const std::string& note : parts_.device->adjust(config_)) waiting_.push_back(Fault{now, "camera", note});
}

Result<std::optional<Event>> CameraSource::next() {
  if (!started_) {
    started_ = true;
    Start start;
    start.time = parts_.clock();
    return std::optional<Event>(std::move(start));
  }
  while (waiting_.empty()) {
    if (stop_) return std::optional<Event>();
    const DeviceTime now = parts_.clock();
    take_adjustment(now);
    if (!running_ && policy_.may_try(now)) try_start(now);
    if (running_)
      look(now);
    else if (waiting_.empty())
      parts_.pause(kLook);
  }
  Event event = std::move(waiting_.front());
  waiting_.pop_front();
  return std::optional(std::move(event));
}

void CameraSource::try_start(DeviceTime now) {
  auto mode = parts_.device->start(config_);
  if (!mode) return fail(now, mode.error().text());
  const DeviceTime ready = parts_.clock();  // starting may have taken long
  running_ = true;
  parts_.counters->running = true;
  stamps_doubted_ = false;
  policy_.on_started(ready);
  gaps_.on_restart();
  offsets_ = parts_.offsets();
  offsets_read_ = ready;
  if (mode.value().notes == last_notes_) return;
  last_notes_ = std::move(mode).value().notes;
  for (const std::string& note : last_notes_) waiting_.push_back(Fault{ready, "camera", note});
}

// The same trouble again and again is told once.
void CameraSource::fail(DeviceTime now, const std::string& why) {
  parts_.device->stop();
  if (running_) ++parts_.counters->restarts;
  running_ = false;
  parts_.counters->running = false;
  policy_.on_failure(now);
  if (why != last_failure_) waiting_.push_back(Fault{now, "camera", why});
  last_failure_ = why;
}

void CameraSource::look(DeviceTime now) {
  auto taken = parts_.device->next(kLook);
  if (!taken) return fail(now, taken.error().text());
  const DeviceTime arrival = parts_.clock();
  if (taken.value()) return on_picture(*taken.value(), arrival);
  if (policy_.is_stalled(arrival))
    fail(arrival, "no picture for " + std::to_string(std::llround(config_.stall_s * 1000)) + " ms; it is started anew");
}

void CameraSource::on_picture(const CapturedImage& image, DeviceTime now) {
  const FrameGaps::Counted counted = gaps_.on(image.sequence);
  parts_.counters->lost = gaps_.lost();
  if (gaps_.lost() > lost_told_ && now - lost_told_at_ > kTellLostEvery) {
    waiting_.push_back(Fault{now, "camera", std::to_string(gaps_.lost() - lost_told_) + " pictures were lost on the way"});
    lost_told_ = gaps_.lost();
    lost_told_at_ = now;
  }
  auto frame = image.damaged ? Result<Frame>(Error{ErrorCode::kMalformed, "a damaged picture", "camera"}) : frame_of(image);
  if (!frame) {
    // It lives, but this picture is of no use; if all are, that is a stall.
    if (++parts_.counters->damaged == 1) waiting_.push_back(Fault{now, "camera", frame.error().text()});
    if (policy_.is_stalled(now)) fail(now, frame.error().text());
    return;
  }
  policy_.on_picture(now);
  last_failure_.clear();
  Frame result = std::move(frame).value();
  result.time = time_of_picture(image, now);
  result.sequence = counted.sequence;
  // A driver's clock that steps back must not turn time round.
  if (last_time_ && result.time <= *last_time_) {
    ++parts_.counters->damaged;
    return;
  }
  last_time_ = result.time;
  ++parts_.counters->frames;
  waiting_.push_back(std::move(result));
}

DeviceTime CameraSource::time_of_picture(const CapturedImage& image, DeviceTime arrival) {
  if (arrival - offsets_read_ > kReadOffsetsEvery) {
    offsets_ = parts_.offsets();
    offsets_read_ = arrival;
  }
  ShutterTiming shutter = shutter_;
  if (image.exposure) shutter.exposure = *image.exposure;
  const auto stamped = device_time(image.stamp, offsets_, arrival);
  if (!stamped && !stamps_doubted_) {
    stamps_doubted_ = true;
    waiting_.push_back(Fault{arrival, "camera", "its time stamps are of no known clock; the time of arrival is used"});
  }
  // A picture arrives when it has been read out.
  const StampInstant instant = stamped ? image.stamp.instant : StampInstant::kReadoutEnd;
  return stamped.value_or(arrival) + to_mid_exposure(instant, shutter) + Duration::from_seconds(config_.time_offset_s);
}

Result<Frame> CameraSource::frame_of(const CapturedImage& image) const {
  Frame frame;
  frame.width_px = window_.width_px;
  frame.height_px = window_.height_px;
  if (image.format != PixelFormat::kMjpeg) {
    auto grey = grey_of(image, window_);
    if (!grey) return grey.error();
    frame.grey = std::move(grey).value();
    if (journal_.frames == "jpeg")
      if (const Status s = compress(frame, static_cast<int>(journal_.jpeg_quality)); !s) return s.error();
    return frame;
  }
  Frame whole = frame;
  whole.width_px = image.width_px;
  whole.height_px = image.height_px;
  whole.encoding = "jpeg";
  whole.encoded = std::make_shared<const std::vector<std::uint8_t>>(image.bytes.begin(), image.bytes.end());
  if (const Status s = decode_image(whole); !s) return Error{s.error().code, s.error().what, "camera"};
  if (window_.is_whole(image)) return whole;
  frame.grey = cut(*whole.grey, image.width_px, image.height_px, window_);
  if (journal_.frames == "jpeg")
    if (const Status s = compress(frame, static_cast<int>(journal_.jpeg_quality)); !s) return s.error();
  return frame;
}

}  // namespace rfmvo
