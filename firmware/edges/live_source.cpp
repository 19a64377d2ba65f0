#include "edges/live_source.hpp"

#include <chrono>
#include <string>
#include <utility>

namespace rfmvo {
namespace {

constexpr std::size_t kMaxFrames = 64;       // the camera waits: 20 MB of 640 x 480
constexpr std::size_t kMaxEvents = 100'000;  // reads are dropped, counted in a fault: 100 s at 1000/s
constexpr Duration kReaderPoll{100'000'000};
constexpr Duration kLastReadsWithin{500'000'000};
constexpr std::chrono::seconds kTickAfter{1};
constexpr std::chrono::milliseconds kLookAgain{50};

}  // namespace

LiveSource::LiveSource(const MakeCamera& make_camera, std::unique_ptr<Reader> reader, DeviceClockFunction clock)
    : clock_(std::move(clock)), camera_(make_camera(stop_)), reader_(std::move(reader)) {
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
    changed_.wait(lock, [this] { return stop_ || frames_waiting_ < kMaxFrames; });
    const bool is_start = std::holds_alternative<Start>(*event.value());
    frames_waiting_ += std::holds_alternative<Frame>(*event.value()) ? 1 : 0;
    // The stream begins with the Start, however early the reader was.
    if (is_start)
      queue_.push_front(*std::move(event).value());
    else
      queue_.push_back(*std::move(event).value());
    started_ = started_ || is_start;
    changed_.notify_all();
  }
}

void LiveSource::run_reader() {
  while (!stop_) push(reader_->poll(kReaderPoll));
  reader_->stop();
}

void LiveSource::push(std::vector<Event> events) {
  if (events.empty()) return;
  const std::lock_guard lock(mutex_);
  for (Event& event : events) {
    if (queue_.size() >= kMaxEvents) {
      if (dropped_++ == 0) queue_.push_back(Fault{clock_(), "reader", "reads are dropped: the estimator is too slow"});
      continue;
    }
    if (dropped_ > 0)
      queue_.push_back(Fault{clock_(), "reader", std::to_string(std::exchange(dropped_, 0)) + " reads were dropped"});
    queue_.push_back(std::move(event));
  }
  changed_.notify_all();
}

Result<std::optional<Event>> LiveSource::next() {
  std::unique_lock lock(mutex_);
  const auto tick_at = std::chrono::steady_clock::now() + kTickAfter;
  while (queue_.empty() || !started_) {
    if (camera_error_) return *camera_error_;
    if (camera_ended_ && (reader_ == nullptr || clock_() - *camera_ended_ > kLastReadsWithin))
      return std::optional<Event>();
    if (started_ && std::chrono::steady_clock::now() >= tick_at) return std::optional<Event>(Tick{clock_()});
    changed_.wait_for(lock, kLookAgain);
  }
  // A reader never falls silent: once the camera has ended and its last reads had time to come, so does the stream.
  if (camera_ended_ && time_of(queue_.front()) - *camera_ended_ > kLastReadsWithin) return std::optional<Event>();
  Event event = std::move(queue_.front());
  queue_.pop_front();
  if (std::holds_alternative<Frame>(event)) --frames_waiting_;
  changed_.notify_all();
  return std::optional(std::move(event));
}

}  // namespace rfmvo
