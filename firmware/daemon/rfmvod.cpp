// rfmvod: the program on the box. Composition root: reads the configuration, opens the edges, runs
// the one loop, ends cleanly on SIGTERM and SIGINT.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <filesystem>

#include "config/config_table.hpp"
#include "edges/image_folder.hpp"
#include "edges/journal.hpp"
#include "edges/lcm_bus.hpp"
#include "edges/live_images.hpp"
#include "edges/live_source.hpp"
#include "edges/open_reader.hpp"
#include "edges/sources.hpp"
#include "edges/stop_signal.hpp"
#include "edges/tee.hpp"
#include "edges/toml_files.hpp"

namespace rfmvo {
namespace {

struct Options {
  std::string config;
  std::string journal;  // overrides journal.directory
  std::string result;   // what was published, as a result log
  std::vector<std::string> settings;  // "section.key=value", over the configuration
};

struct OpenedSource {
  std::unique_ptr<EventSource> events;  // the first one is a Start
  DeviceTime start;
};

Result<OpenedSource> open_journal(const std::string& path, const Config& config) {
  const auto summary = summarise_journal(path, config.lcm.prefix);
  if (!summary) return summary.error();
  if (const Status s = check_pose_source(summary.value(), config, path); !s) return s.error();
  auto reader = JournalReader::open(path, config.lcm.prefix, {config.estimator.pose_source == "frames"});
  if (!reader) return reader.error();
  return OpenedSource{std::move(reader).value(), summary.value().start.time};
}

// Images as if taken now, and the reader, if there is one.
Result<OpenedSource> open_live(std::unique_ptr<ImageFolder> folder, const Config& config,
                               const std::optional<Calibration>& calibration) {
  const DeviceClockFunction clock = device_clock();
  std::unique_ptr<Reader> reader;
  if (!config.reader.address.empty()) {
    auto opened = open_reader(config, calibration, clock);
    if (!opened) return opened.error();
    reader = std::move(opened).value();
  }
  const double start_s = config.camera.start_time_s;
  const DeviceTime first = start_s > 0.0 ? DeviceTime{Duration::from_seconds(start_s).ns} : clock();
  const auto make_camera = [&](const std::atomic<bool>& stop) {
    return std::make_unique<LiveImages>(std::move(folder), first, clock, stop);
  };
  return OpenedSource{std::make_unique<LiveSource>(make_camera, std::move(reader), clock), first};
}

Result<OpenedSource> open_images(const std::string& directory, const Config& config,
                                 const std::optional<Calibration>& calibration) {
  auto folder = ImageFolder::open(directory);
  if (!folder) return folder.error();
  if (config.estimator.pose_source != "frames")
    return Error{ErrorCode::kUnsupported, "images have no camera poses; \"frames\" is needed", "estimator.pose_source"};
  const CameraModel& own = folder.value()->camera();
  if (calibration && (calibration->camera.width_px != own.width_px || calibration->camera.height_px != own.height_px))
    return Error{ErrorCode::kMalformed,
                 "the camera's width_px and height_px are not those of " + directory + "/calib.txt",
                 config.daemon.calibration};
  if (config.camera.start_time_s == 0.0 && config.reader.address.empty())
    return OpenedSource{std::move(folder).value(), DeviceTime{}};
  return open_live(std::move(folder).value(), config, calibration);
}

Result<OpenedSource> open_source(const Config& config, const std::optional<Calibration>& calibration) {
  const std::string& source = config.camera.source;
  constexpr std::string_view kJournal = "journal:", kImages = "images:";
  if (source.starts_with(kJournal) && !config.reader.address.empty())
    return Error{ErrorCode::kUnsupported, "a journal has its own reads; reader.address must be empty", "camera.source"};
  if (source.starts_with(kJournal)) return open_journal(source.substr(kJournal.size()), config);
  if (source.starts_with(kImages)) return open_images(source.substr(kImages.size()), config, calibration);
  const std::string known = "this version knows images:DIR and journal:FILE, no camera hardware yet";
  if (source.empty()) return Error{ErrorCode::kMalformed, "is not set; " + known, "camera.source"};
  return Error{ErrorCode::kUnsupported, "\"" + source + "\" is not supported; " + known, "camera.source"};
}

// DIR/20231114T221320Z.lcmlog by the time of the Start event; a number is added rather than anything overwritten.
Result<std::string> journal_path(const std::string& directory, DeviceTime start) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) return Error{ErrorCode::kUnwritable, "cannot be made: " + error.message(), directory};
  const std::time_t seconds = start.ns / 1'000'000'000;
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  char stamp[32] = {};
  std::strftime(stamp, sizeof(stamp), "%Y%m%dT%H%M%SZ", &utc);
  std::string path = directory + "/" + stamp + ".lcmlog";
  for (int n = 2; std::filesystem::exists(path); ++n)
    path = directory + "/" + stamp + "-" + std::to_string(n) + ".lcmlog";
  return path;
}

// A bus that fails must not stop the estimator or the journal: said once, counted, said at the end.
class TolerantBus : public EstimateSink {
 public:
  explicit TolerantBus(EstimateSink& bus) : bus_(bus) {}
  ~TolerantBus() override {
    if (lost_ > 0) spdlog::warn("{} estimates were not published", lost_);
  }
  [[nodiscard]] Status publish(const Estimate& estimate) override {
    const Status published = bus_.publish(estimate);
    if (!published && lost_++ == 0) spdlog::warn("{}", published.error().text());
    return Done{};
  }

 private:
  EstimateSink& bus_;
  std::uint64_t lost_ = 0;
};

// A copy of the Start event in front, so that a result says what made it: as `rfmvo replay` writes it.
class ResultLog : public EventSink {
 public:
  ResultLog(EventSink* journal, LogWriter* result) : journal_(journal), result_(result) {}
  [[nodiscard]] Status write(const Event& event) override {
    if (result_ != nullptr && std::holds_alternative<Start>(event))
      if (Status s = result_->write(event); !s) return s;
    return journal_ != nullptr ? journal_->write(event) : Status(Done{});
  }

 private:
  EventSink* journal_;
  LogWriter* result_;
};

Result<std::unique_ptr<LogWriter>> open_log(const std::string& path, const std::string& prefix) {
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
    if (const Status s = set_value_from_text(config, setting.substr(0, equals), setting.substr(equals + 1)); !s) return s;
  }
  return check_consistency(config);
}

Status serve(const Options& options) {
  auto read = read_config(options.config);
  if (!read) return read.error();
  Config config = std::move(read).value();
  if (const Status s = apply(options.settings, config); !s) return s;
  if (!options.journal.empty()) config.journal.directory = options.journal;
  const auto calibration = calibration_of(config);
  if (!calibration) return calibration.error();
  auto source = open_source(config, calibration.value());
  if (!source) return source.error();
  auto bus = LcmBus::create(config.lcm.url, config.lcm.prefix);
  if (!bus) return bus.error();

  std::string path;
  if (!config.journal.directory.empty()) {
    auto chosen = journal_path(config.journal.directory, source.value().start);
    if (!chosen) return chosen.error();
    path = std::move(chosen).value();
  }
  auto journal = open_log(path, config.lcm.prefix);
  if (!journal) return journal.error();
  auto result = open_log(options.result, config.lcm.prefix);
  if (!result) return result.error();
  LogWriter* const journal_log = journal.value().get();
  LogWriter* const result_log = result.value().get();

  catch_stop_signals();
  ReconfiguredSource configured(*source.value().events, config, calibration.value());
  StoppableSource events(configured, stop_requested);
  ResultLog journal_and_start(journal_log, result_log);
  TolerantBus tolerant(*bus.value());
  Tee out;
  out.add(tolerant);
  if (result_log != nullptr) out.add(*result_log);
  Pipeline pipeline;
  spdlog::info("running on {}, publishing on {}", config.camera.source, config.lcm.url);
  const Status ran = run(events, &journal_and_start, pipeline, out);
  // What was recorded until trouble came is worth keeping.
  if (journal_log != nullptr) {
    if (const Status s = journal_log->close(); !s) return ran ? s : ran;
    spdlog::info("journal {}", path);
  }
  if (ran && result_log != nullptr)
    if (const Status s = result_log->close(); !s) return s;
  return ran;
}

}  // namespace
}  // namespace rfmvo

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_st("rfmvod"));
  spdlog::set_pattern("rfmvod: %l: %v");
  CLI::App app("Locates RFID tags in 3D and the metric scale of its camera's path; publishes both over LCM", "rfmvod");
  app.set_version_flag("--version", "rfmvod " RFMVO_VERSION);
  rfmvo::Options options;
  app.add_option("--config", options.config, "Configuration (TOML)")->required();
  app.add_option("--journal", options.journal, "Folder for the journal, instead of journal.directory");
  app.add_option("--result", options.result, "Write what is published to this log, too");
  app.add_option("--set", options.settings, "One setting over the configuration: section.key=value")
      ->allow_extra_args(false);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "rfmvod: %s\n", error.what());
    return 2;
  }
  const rfmvo::Status status = rfmvo::serve(options);
  if (status) return 0;
  std::fprintf(stderr, "rfmvod: %s\n", status.error().text().c_str());
  return 1;
}
