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

class LiveSource : public EventSource {
 public:
  // Makes the camera, given what tells it to stop. The stream begins with the camera's Start and ends half a second
  // after its last frame. `reader` may be null.
  using MakeCamera = std::function<std::unique_ptr<EventSource>(const std::atomic<bool>& stop)>;
  LiveSource(const MakeCamera& make_camera, std::unique_ptr<Reader> reader, DeviceClockFunction clock);
  ~LiveSource() override;  // leaves the reader in order

  // Waits; a Tick if nothing has come for a second. A camera's error ends the stream with it.
  [[nodiscard]] Result<std::optional<Event>> next() override;

 private:
  void run_camera();
  void run_reader();
  void push(std::vector<Event> events);
  void stop();

  DeviceClockFunction clock_;
  std::atomic<bool> stop_{false};
  std::unique_ptr<EventSource> camera_;
  std::unique_ptr<Reader> reader_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Event> queue_;
  std::size_t frames_waiting_ = 0;
  std::uint64_t dropped_ = 0;  // and not yet told
  bool started_ = false;       // the Start is out, or under way
  std::optional<DeviceTime> camera_ended_;
  std::optional<Error> camera_error_;

  std::thread camera_thread_, reader_thread_;
};

}  // namespace rfmvo
