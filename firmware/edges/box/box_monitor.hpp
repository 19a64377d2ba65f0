// Looks on while the one loop runs: what comes, what goes, how long it takes. Once a second it makes a status of it.
// Used by the loop's thread alone.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "edges/box/latency_window.hpp"
#include "edges/camera/camera_source.hpp"
#include "edges/lcm_codec.hpp"
#include "edges/live_source.hpp"
#include "edges/recorder/journal_recorder.hpp"

namespace rfmvo {

// What only others know, as of now.
struct BoxReadings {
  LiveCounters live;
  std::uint64_t frames_lost = 0, frames_damaged = 0, camera_restarts = 0;
  bool camera_running = false;
  JournalRecorder::Counters journal;
  std::uint64_t unpublished = 0;
  Duration cpu_time;
  std::int64_t memory_bytes = 0, disk_free_bytes = -1;
  std::optional<double> temperature_c;
  bool clock_set = false, clock_synchronised = false;
};

class BoxMonitor {
 public:
  static constexpr Duration kPeriod{1'000'000'000};

  BoxMonitor(DeviceTime start, std::string prefix);

  void on_event(const Event& event);
  void on_estimate(const Estimate& estimate);
  void on_delay(Duration delay) { delays_.add(delay); }
  [[nodiscard]] bool is_due(DeviceTime now) const { return now - last_ >= kPeriod; }
  // BOX. Begins a new period.
  [[nodiscard]] LcmMessage status(DeviceTime now, const BoxReadings& readings);
  // The same in one line, for people: systemctl status.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static constexpr std::size_t kRecentFaults = 8;
  std::string prefix_;
  DeviceTime start_, last_;
  std::uint64_t frames_ = 0, reads_ = 0, estimates_ = 0, faults_ = 0;
  std::uint64_t last_frames_ = 0, last_reads_ = 0, last_estimates_ = 0;
  Duration last_cpu_time_;
  std::optional<Health> health_;
  VoStatus vo_status_ = VoStatus::kInitialising;
  ReaderStatus reader_;
  std::deque<std::string> recent_faults_;
  LatencyWindow delays_;
  std::string text_;
};

}  // namespace rfmvo
