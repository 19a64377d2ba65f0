#include "daemon/service.hpp"

#include <spdlog/spdlog.h>

#include <ctime>
#include <filesystem>
#include <utility>

#include "config/config_table.hpp"
#include "daemon/open_source.hpp"
#include "daemon/run_loop.hpp"
#include "daemon/shutdown_guard.hpp"
#include "edges/box/config_port.hpp"
#include "edges/box/self_test.hpp"
#include "edges/box/service_notify.hpp"
#include "edges/box/settings_file.hpp"
#include "edges/journal.hpp"
#include "edges/sources.hpp"
#include "edges/stop_signal.hpp"
#include "edges/toml_files.hpp"

namespace rfmvo {
namespace {

constexpr std::int64_t kMega = 1'000'000;

// DIR/20231114T221320Z by the time of the Start event; a number is added rather than anything overwritten.
Result<std::string> journal_run(const std::string& directory, DeviceTime start) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) return Error{ErrorCode::kUnwritable, "cannot be made: " + error.message(), directory};
  for (const Recovered& whole : recover_segments(directory))
    spdlog::warn("{}: was not closed; {} records are whole, {} bytes behind them were cut off", whole.path,
                 whole.records, whole.bytes_cut);
  const std::time_t seconds = start.ns / 1'000'000'000;
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  char stamp[32] = {};
  std::strftime(stamp, sizeof(stamp), "%Y%m%dT%H%M%SZ", &utc);
  const std::string first = directory + "/" + stamp;
  const auto is_taken = [](const std::string& run) {
    return std::filesystem::exists(run + ".lcmlog") || std::filesystem::exists(run + ".lcmlog.tmp");
  };
  std::string run = first;
  for (int n = 2; is_taken(run); ++n) run = first + "-" + std::to_string(n);
  return run;
}

// Null: no journal.
Result<std::unique_ptr<JournalRecorder>> open_recorder(const Config& config, DeviceTime start, bool live,
                                                       std::string& path) {
  if (config.journal.directory.empty()) return std::unique_ptr<JournalRecorder>();
  auto run = journal_run(config.journal.directory, start);
  if (!run) return run.error();
  auto store =
      SegmentedStore::create(run.value(), {config.journal.segment_mb * kMega, config.journal.quota_mb * kMega});
  if (!store) return store.error();
  path = store.value()->first_path();
  return std::make_unique<JournalRecorder>(
      std::move(store).value(), JournalRecorder::Settings{config.lcm.prefix, config.journal.queue_mb * kMega,
                                                          Duration::from_seconds(config.journal.flush_s), live});
}

Result<std::unique_ptr<LogWriter>> open_result(const std::string& path, const std::string& prefix) {
  if (path.empty()) return std::unique_ptr<LogWriter>();
  return LogWriter::create(path, prefix);
}

Result<std::optional<Calibration>> calibration_of(const Config& config) {
  if (config.daemon.calibration.empty()) return std::optional<Calibration>();
  auto calibration = read_calibration(config.daemon.calibration);
  if (!calibration) return calibration.error();
  return std::optional<Calibration>(std::move(calibration).value());
}

Status apply(const std::vector<std::string>& settings, Config& config) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos)
      return Error{ErrorCode::kMalformed, "expects section.key=value, not " + setting, "--set"};
    if (const Status s = set_value_from_text(config, setting.substr(0, equals), setting.substr(equals + 1)); !s)
      return s;
  }
  return check_consistency(config);
}

// What was recorded until trouble came is worth keeping.
Status close_journal(JournalRecorder* journal, const std::string& path) {
  if (journal == nullptr) return Done{};
  const Status closed = journal->close();
  const JournalLoss lost = journal->counters().lost;
  if (lost.any()) spdlog::warn("{}: {} frames and {} other events are missing", path, lost.frames, lost.others);
  if (closed) spdlog::info("journal {}", path);
  return closed;
}

// A setting that the command line holds fast cannot be changed.
Result<Config> change_setting(const Options& options, const std::string& key, const std::string& value) {
  for (const std::string& setting : options.settings)
    if (setting.starts_with(key + "="))
      return Error{ErrorCode::kUnsupported, "is set on the command line of rfmvod", key};
  const auto written = read_config(options.config);
  if (!written) return written.error();
  auto changed = SettingsFile(options.settings_file).set(written.value(), key, value);
  if (!changed) return changed.error();
  request_reload();
  return changed;
}

// The configuration's door on the bus; null: this bus has none.
Result<std::unique_ptr<ConfigPort>> open_config_port(const Options& options, const Config& config,
                                                     const Reloading& reloading, const DeviceClockFunction& clock) {
  auto secret = random_bytes(Mac{}.size());
  if (!secret) return secret.error();
  std::optional<Key> key;
  if (!config.daemon.key_file.empty()) {
    auto read = read_key(config.daemon.key_file);
    if (!read) spdlog::warn("{}; the configuration cannot be changed from afar", read.error().text());
    if (read) key = std::move(read).value();
  }
  ConfigServer::Doors doors{
      [&reloading] { return reloading.running(); },
      [&options](const std::string& name, const std::string& value) { return change_setting(options, name, value); }};
  return ConfigPort::open(config.lcm.url, config.lcm.prefix,
                          std::make_unique<ConfigServer>(std::move(doors), std::move(key), std::move(secret).value()),
                          clock);
}

struct RunEnd {
  bool reload = false;
};

Result<RunEnd> run_once(const Options& options, const Config& config, const ServiceNotify& notify) {
  const auto calibration = calibration_of(config);
  if (!calibration) return calibration.error();
  Reloading reloading(options, config);
  auto source =
      open_source(config, calibration.value(), [&reloading] { return stop_requested() || reloading.wants_new_run(); });
  if (!source) return source.error();
  OpenedSource opened = std::move(source).value();
  auto bus = LcmBus::create(config.lcm.url, config.lcm.prefix);
  if (!bus) return bus.error();
  std::string path;
  auto recorder = open_recorder(config, opened.start, opened.live != nullptr, path);
  if (!recorder) return recorder.error();
  auto result = open_result(options.result, config.lcm.prefix);
  if (!result) return result.error();
  JournalRecorder* const journal = recorder.value().get();
  LogWriter* const result_log = result.value().get();

  auto port = opened.live != nullptr ? open_config_port(options, config, reloading, opened.clock)
                                     : std::unique_ptr<ConfigPort>();
  if (!port) return port.error();

  std::optional<ShutdownGuard> guard;
  if (opened.live != nullptr) guard.emplace(journal);
  RunLoop loop({config, calibration.value(), opened, *bus.value(), journal, result_log, reloading, notify});
  spdlog::info("running on {}, publishing on {}", config.camera.source, config.lcm.url);
  const Status ran = loop.run();
  const Status closed = close_journal(journal, path);
  guard.reset();
  if (!ran) return ran.error();
  if (!closed) return closed.error();
  if (result_log != nullptr)
    if (const Status s = result_log->close(); !s) return s.error();
  return RunEnd{reloading.wants_new_run()};
}

}  // namespace

Result<Config> load_config(const Options& options) {
  const auto written = read_config(options.config);
  if (!written) return written.error();
  auto over = SettingsFile(options.settings_file).over(written.value());
  if (!over) return over.error();
  Config config = std::move(over).value();
  if (const Status s = apply(options.settings, config); !s) return s.error();
  if (!options.journal.empty()) config.journal.directory = options.journal;
  return config;
}

Status serve(const Options& options) {
  catch_stop_signals();
  catch_reload_signal();
  const ServiceNotify notify;
  const Check clock = check_clock(system_clock());
  if (!clock.ok) spdlog::warn("clock: {}", clock.text);
  auto loaded = load_config(options);
  if (!loaded) return loaded.error();
  Config config = std::move(loaded).value();
  std::optional<Config> proven;  // the last one that a run could begin with
  while (true) {
    const auto end = run_once(options, config, notify);
    if (!end && !(proven && !stop_requested())) return end.error();
    if (!end) {
      // A setting from afar must not put the box out of reach.
      spdlog::error("{}; back to the configuration before", end.error().text());
      config = *std::exchange(proven, std::nullopt);
      continue;
    }
    if (!end.value().reload || stop_requested()) break;
    proven = config;
    auto next = load_config(options);
    if (!next) return next.error();
    config = std::move(next).value();
    spdlog::info("a new run with the new configuration");
  }
  notify.stopping();
  return Done{};
}

}  // namespace rfmvo
