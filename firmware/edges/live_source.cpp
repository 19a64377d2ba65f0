#include "edges/live_source.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

namespace rfmvo {
namespace {

constexpr std::size_t kMaxFrames = 64;       // 20 MB of 640 x 480
constexpr std::size_t kMaxEvents = 100'000;  // reads are dropped, with a fault: 100 s at 1000/s
constexpr Duration kReaderPoll{100'000'000};
constexpr Duration kLastReadsWithin{500'000'000};
constexpr Duration kTellDropsEvery{1'000'000'000};
constexpr std::chrono::seconds kTickAfter{1};
constexpr std::chrono::milliseconds kLookAgain{50};

}  // namespace

LiveSource::LiveSource(const MakeCamera& make_camera, std::unique_ptr<Reader> reader, DeviceClockFunction clock)
    : LiveSource(make_camera, std::move(reader), std::move(clock), Options{}) {}

LiveSource::LiveSource(const MakeCamera& make_camera, std::unique_ptr<Reader> reader, DeviceClockFunction clock,
                       Options options)
    : clock_(std::move(clock)), camera_(make_camera(stop_)), reader_(std::move(reader)), options_(std::move(options)) {
  camera_thread_ = std::thread([this] { run_camera(); });
  if (reader_ != nullptr) reader_thread_ = std::thread([this] { run_reader(); });
}

LiveSource::~LiveSource() { stop(); }

void LiveSource::stop() {
  {
    const std::lock_guard lock(mutex_);  // else the camera's thread could miss it between looking and waiting
    stop_ = true;
  }
  changed_.notify_all();
  if (reader_ != nullptr) reader_->wake();
  if (camera_thread_.joinable()) camera_thread_.join();
  if (reader_thread_.joinable()) reader_thread_.join();
}

void LiveSource::run_camera() {
  while (!stop_) {
    auto event = camera_->next();
    std::unique_lock lock(mutex_);
    if (!event || !event.value()) {
      if (!event) camera_error_ = event.error();
      camera_ended_ = clock_();
      changed_.notify_all();
      return;
    }
    const bool is_start = std::holds_alternative<Start>(*event.value());
    const bool is_frame = std::holds_alternative<Frame>(*event.value());
    if (is_frame) make_room_for_frame(lock);
    frames_waiting_ += is_frame ? 1 : 0;
    Arrived arrived{*std::move(event).value(), clock_()};
    // The stream begins with the Start, however early the reader was.
    if (is_start)
      queue_.push_front(std::move(arrived));
    else
      queue_.push_back(std::move(arrived));
    started_ = started_ || is_start;
    changed_.notify_all();
  }
}

void LiveSource::make_room_for_frame(std::unique_lock<std::mutex>& lock) {
  if (options_.when_full == WhenFull::kWait) {
    changed_.wait(lock, [this] { return stop_ || frames_waiting_ < kMaxFrames; });
    return;
  }
  if (frames_waiting_ < kMaxFrames) return;
  const auto oldest = std::find_if(queue_.begin(), queue_.end(),
                                   [](const Arrived& a) { return std::holds_alternative<Frame>(a.event); });
  queue_.erase(oldest);
  --frames_waiting_;
  ++frames_dropped_;
}

// In the stream itself, so that the journal has it too; not each one.
void LiveSource::tell_drops(DeviceTime now) {
  const std::uint64_t dropped = frames_dropped_ + reads_dropped_;
  if (dropped == drops_told_ || now - drops_told_at_ < kTellDropsEvery) return;
  queue_.push_front({Fault{now, "daemon",
                           "the estimator is too slow: " + std::to_string(frames_dropped_) + " frames and " +
                               std::to_string(reads_dropped_) + " reads were dropped so far"},
                     now});
  drops_told_ = dropped;
  drops_told_at_ = now;
}

void LiveSource::run_reader() {
  while (!stop_) push(reader_->poll(kReaderPoll));
  reader_->stop();
}

void LiveSource::post(Event event) {
  const std::lock_guard lock(mutex_);
  queue_.push_back({std::move(event), clock_()});
  changed_.notify_all();
}

LiveCounters LiveSource::counters() const {
  const std::lock_guard lock(mutex_);
  return {frames_dropped_, reads_dropped_, frames_waiting_, queue_.size()};
}

void LiveSource::push(std::vector<Event> events) {
  if (events.empty()) return;
  const std::lock_guard lock(mutex_);
  for (Event& event : events) {
    if (queue_.size() < kMaxEvents)
      queue_.push_back({std::move(event), clock_()});
    else
      ++reads_dropped_;
  }
  changed_.notify_all();
}

Result<std::optional<Event>> LiveSource::next() {
  std::unique_lock lock(mutex_);
  const auto tick_at = std::chrono::steady_clock::now() + kTickAfter;
  const auto no_longer = [this] {
    if (!stop_ && options_.should_stop()) {
      stop_ = true;  // camera and reader leave while what has arrived is worked off
      if (reader_ != nullptr) reader_->wake();
    }
    return stop_.load();
  };
  while (!no_longer() && (queue_.empty() || !started_)) {
    if (camera_error_) return *camera_error_;
    if (camera_ended_ && (reader_ == nullptr || clock_() - *camera_ended_ > kLastReadsWithin))
      return std::optional<Event>();
    if (started_ && std::chrono::steady_clock::now() >= tick_at) {
      last_arrival_ = clock_();
      return std::optional<Event>(Tick{last_arrival_});
    }
    changed_.wait_for(lock, kLookAgain);
  }
  if (queue_.empty() || !started_) return std::optional<Event>();
  tell_drops(clock_());
  // A reader never falls silent: once the camera has ended and its last reads had time to come, so does the stream.
  if (!stop_ && camera_ended_ && time_of(queue_.front().event) - *camera_ended_ > kLastReadsWithin)
    return std::optional<Event>();
  Arrived arrived = std::move(queue_.front());
  queue_.pop_front();
  last_arrival_ = arrived.time;
  if (std::holds_alternative<Frame>(arrived.event)) --frames_waiting_;
  changed_.notify_all();
  return std::optional(std::move(arrived.event));
}

}  // namespace rfmvo
