#include "daemon/run_loop.hpp"

#include <spdlog/spdlog.h>

#include "config/config_table.hpp"
#include "edges/box/machine.hpp"
#include "edges/box/settings_file.hpp"
#include "edges/sources.hpp"
#include "edges/stop_signal.hpp"
#include "edges/thread_worker.hpp"

namespace rfmvo {
Result<std::vector<Command>> Reloading::look(DeviceTime now) {
  auto loaded = load_config(options_);
  if (!loaded) return loaded.error();
  std::vector<Command> commands;
  bool more = false;
  for (const ConfigRow& row : config_rows()) {
    const ConfigValue value = get_value(loaded.value(), row);
    if (value == get_value(running_, row)) continue;
    if (row.live)
      commands.push_back({now, std::string(row.key), text_of(value)});
    else
      more = true;
  }
  if (more) {
    new_run_ = true;
    return std::vector<Command>();
  }
  const std::lock_guard lock(mutex_);
  running_ = std::move(loaded).value();
  return commands;
}

Config Reloading::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

// Source, journal and sink of the loop in one: it sees every event come, and when all that follows from it is out.
class RunLoop::Around : public EventSource, public EventSink, public EstimateSink {
 public:
  explicit Around(Parts& parts)
      : parts_(parts), monitor_(parts.source.clock(), parts.config.lcm.prefix), last_alive_(parts.source.clock()) {}
  ~Around() override {
    if (unpublished_ > 0) spdlog::warn("{} estimates were not published", unpublished_);
  }

  [[nodiscard]] Result<std::optional<Event>> next() override {
    if (parts_.source.live == nullptr && stop_requested()) return std::optional<Event>();
    const DeviceTime now = parts_.source.clock();
    finish_event(now);
    if (parts_.source.live != nullptr && take_reload_request()) reload(now);
    auto next = parts_.source.events->next();
    if (!next || !next.value()) return next;
    // Asked again: the source may have waited until a signal came.
    if (parts_.source.live == nullptr && stop_requested()) return std::optional<Event>();
    const Event& event = *next.value();
    monitor_.on_event(event);
    if (const auto* fault = std::get_if<Fault>(&event)) spdlog::warn("{}: {}", fault->source, fault->text);
    // Waiting for a camera is no delay of ours.
    arrival_ = parts_.source.live != nullptr ? std::optional(parts_.source.live->last_arrival()) : std::nullopt;
    return next;
  }

  [[nodiscard]] Status write(const Event& event) override {
    // A copy of the Start in front, so that a result says what made it: as `rfmvo replay` writes it.
    if (parts_.result != nullptr && std::holds_alternative<Start>(event))
      if (const Status s = parts_.result->write(event); !s) return s;
    return parts_.journal != nullptr ? parts_.journal->write(event) : Status(Done{});
  }

  // A bus that fails must not stop the estimator or the journal: said once, counted.
  [[nodiscard]] Status publish(const Estimate& estimate) override {
    monitor_.on_estimate(estimate);
    if (const Status s = parts_.bus.publish(estimate); !s && unpublished_++ == 0) spdlog::warn("{}", s.error().text());
    return parts_.result != nullptr ? parts_.result->publish(estimate) : Status(Done{});
  }

 private:
  // The event before is done with, with all that followed from it: progress that systemd may believe in.
  void finish_event(DeviceTime now) {
    if (arrival_) monitor_.on_delay(now - *arrival_);
    if (!ready_ && begun_) {
      parts_.notify.ready("running on " + parts_.config.camera.source);
      ready_ = true;
    }
    begun_ = true;
    constexpr std::int64_t kPingsPerTimeout = 4;
    const auto watchdog = parts_.notify.watchdog();
    if (watchdog && now - last_alive_ > Duration{watchdog->ns / kPingsPerTimeout}) {
      parts_.notify.alive();
      last_alive_ = now;
    }
    if (parts_.source.live != nullptr && monitor_.is_due(now)) {
      if (const Status s = parts_.bus.publish(monitor_.status(now, readings())); !s && unpublished_++ == 0)
        spdlog::warn("{}", s.error().text());
      parts_.notify.status(monitor_.text());
    }
  }

  [[nodiscard]] BoxReadings readings() const {
    BoxReadings r;
    r.live = parts_.source.live->counters();
    const CameraCounters& camera = *parts_.source.camera_counters;
    r.camera_running = camera.running;
    r.frames_lost = camera.lost;
    r.frames_damaged = camera.damaged;
    r.camera_restarts = camera.restarts;
    if (parts_.journal != nullptr) r.journal = parts_.journal->counters();
    r.unpublished = unpublished_;
    r.cpu_time = cpu_time();
    r.memory_bytes = resident_bytes();
    r.disk_free_bytes = disk_free_bytes(parts_.config.journal.directory).value_or(-1);
    r.temperature_c = temperature_c();
    const SystemClock clock = system_clock();
    r.clock_set = clock.is_set();
    r.clock_synchronised = clock.synchronised;
    return r;
  }

  void reload(DeviceTime now) {
    parts_.notify.reloading();
    const auto commands = parts_.reloading.look(now);
    if (!commands) {
      spdlog::error("{}; the configuration stays as it is", commands.error().text());
      parts_.source.live->post(Fault{now, "configuration", commands.error().text()});
    } else {
      for (const Command& command : commands.value()) {
        spdlog::info("{} = {}", command.key, command.value);
        parts_.source.live->post(command);
      }
      const CameraConfig camera = parts_.reloading.running().camera;
      if (parts_.source.camera != nullptr) parts_.source.camera->adjust(camera.exposure_s, camera.gain);
    }
    parts_.notify.ready("running on " + parts_.config.camera.source);
  }

  Parts& parts_;
  BoxMonitor monitor_;
  DeviceTime last_alive_;
  std::optional<DeviceTime> arrival_;
  std::uint64_t unpublished_ = 0;
  bool begun_ = false, ready_ = false;
};

RunLoop::RunLoop(Parts parts) : parts_(parts) {}

Status RunLoop::run() {
  Around around(parts_);
  ReconfiguredSource events(around, parts_.config, parts_.calibration);
  ThreadWorker worker;
  Pipeline pipeline(&worker);
  return rfmvo::run(events, &around, pipeline, around);
}

}  // namespace rfmvo
