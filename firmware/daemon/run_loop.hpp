// One run: the loop of edges/event_io with everything around it that a box needs - systemd, health, reload.
#pragma once

#include <mutex>
#include <optional>

#include "daemon/open_source.hpp"
#include "daemon/service.hpp"
#include "edges/box/box_monitor.hpp"
#include "edges/box/service_notify.hpp"
#include "edges/journal.hpp"
#include "edges/lcm_bus.hpp"
#include "edges/recorder/journal_recorder.hpp"

namespace rfmvo {

// What a changed configuration file means for the run at hand.
class Reloading {
 public:
  Reloading(const Options& options, const Config& running) : options_(options), running_(running) {}
  // Reads the file again. Commands for what can change live; if more has changed, wants_new_run(). A file that is wrong
  // changes nothing: the error.
  [[nodiscard]] Result<std::vector<Command>> look(DeviceTime now);
  [[nodiscard]] bool wants_new_run() const { return new_run_; }
  [[nodiscard]] Config running() const;  // from any thread

 private:
  const Options& options_;
  mutable std::mutex mutex_;
  Config running_;
  std::atomic<bool> new_run_{false};
};

class RunLoop {
 public:
  struct Parts {
    const Config& config;
    const std::optional<Calibration>& calibration;
    OpenedSource& source;
    LcmBus& bus;
    JournalRecorder* journal;  // may be null
    LogWriter* result;         // may be null
    Reloading& reloading;
    const ServiceNotify& notify;
  };
  explicit RunLoop(Parts parts);
  [[nodiscard]] Status run();

 private:
  class Around;  // stands before the source and behind the pipeline
  Parts parts_;
};

}  // namespace rfmvo
