// Camera and reader as one stream of events, in order of arrival. Each has a thread of its own, so that neither
// waits for the other or for the estimator; the estimator's thread takes from the queue between them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "edges/device_clock.hpp"
#include "edges/event_io.hpp"
#include "edges/reader.hpp"

namespace rfmvo {

// What a camera does that is ahead of the estimator: files can wait, the world cannot.
enum class WhenFull { kWait, kDropOldestFrame };

struct LiveCounters {
  std::uint64_t frames_dropped = 0, reads_dropped = 0;  // because the estimator was too slow
  std::size_t frames_waiting = 0, events_waiting = 0;
};

class LiveSource : public EventSource {
 public:
  // Makes the camera, given what tells it to stop. The stream begins with the camera's Start and ends half a second
  // after its last frame. `reader` may be null.
  using MakeCamera = std::function<std::unique_ptr<EventSource>(const std::atomic<bool>& stop)>;
  struct Options {
    WhenFull when_full = WhenFull::kWait;
    // Asked all the time: true ends the stream after what has arrived until then.
    std::function<bool()> should_stop = [] { return false; };
  };
  LiveSource(const MakeCamera& make_camera, std::unique_ptr<Reader> reader, DeviceClockFunction clock);
  LiveSource(const MakeCamera& make_camera, std::unique_ptr<Reader> reader, DeviceClockFunction clock, Options options);
  ~LiveSource() override;  // leaves the reader in order

  // Waits; a Tick if nothing has come for a second. A camera's error ends the stream with it.
  [[nodiscard]] Result<std::optional<Event>> next() override;
  // When the event that next() gave last had arrived: what has passed since is this program's doing.
  [[nodiscard]] DeviceTime last_arrival() const { return last_arrival_; }

  // From any thread: an event from elsewhere, an operator's command.
  void post(Event event);
  [[nodiscard]] LiveCounters counters() const;

 private:
  void run_camera();
  void run_reader();
  struct Arrived {
    Event event;
    DeviceTime time;
  };
  void push(std::vector<Event> events);
  void make_room_for_frame(std::unique_lock<std::mutex>& lock);
  void tell_drops(DeviceTime now);
  void stop();

  DeviceClockFunction clock_;
  std::atomic<bool> stop_{false};
  std::unique_ptr<EventSource> camera_;
  std::unique_ptr<Reader> reader_;

  Options options_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Arrived> queue_;
  std::size_t frames_waiting_ = 0;
  std::uint64_t frames_dropped_ = 0, reads_dropped_ = 0, drops_told_ = 0;
  DeviceTime drops_told_at_;
  bool started_ = false;  // the Start is out, or under way
  std::optional<DeviceTime> camera_ended_;
  std::optional<Error> camera_error_;

  DeviceTime last_arrival_;  // of the thread that takes

  std::thread camera_thread_, reader_thread_;
};

}  // namespace rfmvo
