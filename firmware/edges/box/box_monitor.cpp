#include "edges/box/box_monitor.hpp"

#include <cmath>
#include <cstdio>

#include "edges/lcm_codec_parts.hpp"
#include "rfmvo/box_status_t.hpp"

namespace rfmvo {
namespace {

constexpr std::size_t kMaxFaultText = 512;

const char* text_of(VoStatus status) {
  switch (status) {
    case VoStatus::kInitialising:
      return "initialising";
    case VoStatus::kTracking:
      return "tracking";
    case VoStatus::kDegraded:
      return "degraded";
    case VoStatus::kLost:
      return "lost";
  }
  return "?";
}

std::int64_t count_of(std::uint64_t n) { return static_cast<std::int64_t>(n); }

void put(const BoxReadings& readings, box_status_t& m) {
  m.camera_running = readings.camera_running ? 1 : 0;
  m.frames_lost = count_of(readings.frames_lost);
  m.frames_damaged = count_of(readings.frames_damaged);
  m.camera_restarts = count_of(readings.camera_restarts);
  m.frames_dropped = count_of(readings.live.frames_dropped);
  m.reads_dropped = count_of(readings.live.reads_dropped);
  m.frames_waiting = static_cast<std::int32_t>(readings.live.frames_waiting);
  m.events_waiting = static_cast<std::int32_t>(readings.live.events_waiting);
  m.unpublished = count_of(readings.unpublished);
  m.journal_bytes = readings.journal.bytes_written;
  m.journal_waiting_bytes = readings.journal.queue_bytes;
  m.journal_frames_lost = count_of(readings.journal.lost.frames);
  m.journal_others_lost = count_of(readings.journal.lost.others);
  m.journal_error = readings.journal.last_error;
  m.memory_bytes = readings.memory_bytes;
  m.temperature_known = readings.temperature_c ? 1 : 0;
  m.temperature_c = readings.temperature_c.value_or(0.0);
  m.disk_free_bytes = readings.disk_free_bytes;
  m.clock_set = readings.clock_set ? 1 : 0;
  m.clock_synchronised = readings.clock_synchronised ? 1 : 0;
}

}  // namespace

BoxMonitor::BoxMonitor(DeviceTime start, std::string prefix)
    : prefix_(std::move(prefix)), start_(start), last_(start) {}

void BoxMonitor::on_event(const Event& event) {
  frames_ += std::holds_alternative<Frame>(event) ? 1 : 0;
  reads_ += std::holds_alternative<TagRead>(event) ? 1 : 0;
  if (const auto* status = std::get_if<ReaderStatus>(&event)) reader_ = *status;
  if (const auto* fault = std::get_if<Fault>(&event)) {
    ++faults_;
    recent_faults_.push_back((fault->source + ": " + fault->text).substr(0, kMaxFaultText));
    if (recent_faults_.size() > kRecentFaults) recent_faults_.pop_front();
  }
}

void BoxMonitor::on_estimate(const Estimate& estimate) {
  ++estimates_;
  if (const auto* pose = std::get_if<CameraPose>(&estimate)) vo_status_ = pose->status;
  if (const auto* health = std::get_if<Health>(&estimate)) health_ = *health;
}

LcmMessage BoxMonitor::status(DeviceTime now, const BoxReadings& readings) {
  const double period_s = std::max((now - last_).seconds(), 1e-3);
  box_status_t m;
  m.utime = now.us();
  m.uptime_s = (now - start_).seconds();
  m.frames_hz = static_cast<double>(frames_ - last_frames_) / period_s;
  m.reads_hz = static_cast<double>(reads_ - last_reads_) / period_s;
  m.estimates_hz = static_cast<double>(estimates_ - last_estimates_) / period_s;
  m.frames = count_of(frames_);
  m.reads = count_of(reads_);
  put(readings, m);
  m.delay_p50_s = delays_.percentile(0.5).seconds();
  m.delay_p99_s = delays_.percentile(0.99).seconds();
  m.delay_max_s = delays_.percentile(1.0).seconds();
  m.cpu_share = (readings.cpu_time.ns - last_cpu_time_.ns) * 1e-9 / period_s;
  m.vo_status = static_cast<std::int8_t>(vo_status_);
  m.reader = codec::message_of(reader_);
  m.fault_count = count_of(faults_);
  m.faults.assign(recent_faults_.begin(), recent_faults_.end());
  m.recent_faults = static_cast<std::int32_t>(m.faults.size());

  char line[256];
  (void)std::snprintf(line, sizeof(line),
                      "%.0f frames/s, %.0f reads/s, odometry %s, %u of %u tags located, %lld faults", m.frames_hz,
                      m.reads_hz, text_of(vo_status_), health_ ? health_->tags_located : 0u,
                      health_ ? health_->tags : 0u, static_cast<long long>(m.fault_count));
  text_ = line;
  last_ = now;
  last_frames_ = frames_;
  last_reads_ = reads_;
  last_estimates_ = estimates_;
  last_cpu_time_ = readings.cpu_time;
  delays_.clear();
  return codec::pack(m, prefix_, "BOX");
}

}  // namespace rfmvo
