// rfmvo replay: the recorded events through the same loop as on the box (same journal, same configuration, same build:
// same bytes), or the recorded messages onto the bus.
#include <charconv>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/overwrite.hpp"
#include "commands/progress_line.hpp"
#include "commands/whole_file.hpp"
#include "config/config_table.hpp"
#include "edges/journal.hpp"
#include "edges/lcm_bus.hpp"
#include "edges/sources.hpp"
#include "edges/stop_signal.hpp"
#include "edges/tee.hpp"
#include "edges/toml_files.hpp"
#include "play/bus_door.hpp"

namespace rfmvo {
namespace {

struct Options {
  std::string journal, out, config, json;
  std::string estimator, from;  // empty: as configured
  std::string speed = "max";
  std::vector<std::string> settings;
  std::string prefix = LcmConfig{}.prefix;
  std::string bus;  // not empty: played onto it
  std::string channels = ".*";
  double start_s = 0.0, end_s = 0.0;
  play::PlaySettings play;
  bool force = false;
};

struct Figures {
  std::uint64_t events = 0;
  double span_s = 0.0, wall_s = 0.0, cpu_s = 0.0;
  // How many times faster than it happened; 0 = the events have no duration.
  [[nodiscard]] double realtime_factor() const { return cpu_s > 0.0 ? span_s / cpu_s : 0.0; }
};

// 0 = as fast as possible.
double speed_of(const std::string& text) {
  if (text == "max") return 0.0;
  double speed = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), speed);
  if (error != std::errc{} || end != text.data() + text.size() || !(speed > 0.0 && speed <= 1e6))
    throw CLI::ValidationError("--speed", "expects max or a number above 0, not " + text);
  return speed;
}

void check_setting(const std::string& setting) {
  Config scratch;
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos) throw CLI::ValidationError("--set", "expects section.key=value, not " + setting);
  const Status s = set_value_from_text(scratch, setting.substr(0, equals), setting.substr(equals + 1));
  if (!s) throw CLI::ValidationError("--set", s.error().text());
}

// The journal's own configuration, then --config, --set, --estimator and --from, each over the one before.
Result<Config> effective_config(const JournalSummary& journal, const Options& options) {
  Config config = journal.start.config;
  config.estimator.pose_source = journal.frames > 0 ? "frames" : "poses";
  if (!options.config.empty()) {
    auto read = read_config(options.config, config);
    if (!read) return read.error();
    config = std::move(read).value();
  }
  for (const std::string& setting : options.settings) {
    const std::size_t equals = setting.find('=');
    const Status s = set_value_from_text(config, setting.substr(0, equals), setting.substr(equals + 1));
    if (!s) return s.error();
  }
  if (!options.estimator.empty()) config.estimator.kind = options.estimator;
  if (!options.from.empty()) config.estimator.pose_source = options.from;
  if (const Status s = check_consistency(config); !s) return s.error();
  return config;
}

// Copies Start events to the result, so that it says what made it.
class StartToResult : public EventSink {
 public:
  explicit StartToResult(LogWriter& result) : result_(result) {}
  [[nodiscard]] Status write(const Event& event) override {
    return std::holds_alternative<Start>(event) ? result_.write(event) : Status(Done{});
  }

 private:
  LogWriter& result_;
};

Status check_not_itself(const Options& options) {
  std::error_code ignored;
  if (!std::filesystem::equivalent(options.journal, options.out, ignored)) return Done{};
  return Error{ErrorCode::kUnwritable, "is the journal itself", options.out};
}

// Shows on the terminal how far the events have come.
class ShownSource : public EventSource {
 public:
  ShownSource(EventSource& inner, const JournalSummary& journal) : inner_(inner), journal_(journal) {}
  [[nodiscard]] Result<std::optional<Event>> next() override {
    auto event = inner_.next();
    if (event && event.value()) {
      const double all_s = (journal_.last - journal_.first).seconds();
      const double done_s = (time_of(*event.value()) - journal_.first).seconds();
      char text[64] = {};
      (void)std::snprintf(text, sizeof text, "%.1f of %.1f s", done_s, all_s);
      line_.show_share(all_s > 0.0 ? done_s / all_s : 0.0, text);
    }
    return event;
  }

 private:
  EventSource& inner_;
  const JournalSummary& journal_;
  ProgressLine line_{""};
};

// Runs the loop and closes the result.
Status run_to_file(const Options& options, const JournalSummary& journal, const Config& config, double speed) {
  auto reader = JournalReader::open(options.journal, options.prefix, {config.estimator.pose_source == "frames"});
  if (!reader) return reader.error();
  auto result = LogWriter::create(options.out, options.prefix);
  if (!result) return result.error();
  Tee out;
  out.add(*result.value());
  std::unique_ptr<LcmBus> bus;
  if (speed > 0.0) {
    auto opened = LcmBus::create(config.lcm.url, options.prefix);
    if (!opened) return opened.error();
    bus = std::move(opened).value();
    out.add(*bus);
  }
  ReconfiguredSource configured(*reader.value(), config, std::nullopt);
  PacedSource paced(configured, speed > 0.0 ? speed : 1.0);
  EventSource& chosen = speed > 0.0 ? static_cast<EventSource&>(paced) : configured;
  ShownSource shown(chosen, journal);
  StoppableSource events(shown, stop_requested);
  StartToResult start_to_result(*result.value());
  Pipeline pipeline;
  if (const Status s = run(events, &start_to_result, pipeline, out); !s) return s;
  if (stop_requested()) return Error{ErrorCode::kUnreadable, "interrupted; nothing was written", options.out};
  return result.value()->close();
}

Result<Figures> replay(const Options& options, double speed) {
  if (const Status s = check_not_itself(options); !s) return s.error();
  if (const Status s = check_free({options.out, options.json}, options.force); !s) return s.error();
  const auto journal = summarise_journal(options.journal, options.prefix);
  if (!journal) return journal.error();
  const auto config = effective_config(journal.value(), options);
  if (!config) return config.error();
  if (const Status s = check_pose_source(journal.value(), config.value(), options.journal); !s) return s.error();
  const auto wall = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  if (const Status s = run_to_file(options, journal.value(), config.value(), speed); !s) return s.error();
  Figures figures;
  figures.events = journal.value().events;
  figures.span_s = (journal.value().last - journal.value().first).seconds();
  figures.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  figures.cpu_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  return figures;
}

Status write_json(const std::string& path, const Figures& figures) {
  if (path.empty()) return Done{};
  const nlohmann::ordered_json json = {{"realtime_factor", figures.realtime_factor()},
                                       {"events", figures.events},
                                       {"event_span_s", figures.span_s},
                                       {"cpu_s", figures.cpu_s},
                                       {"wall_s", figures.wall_s}};
  return write_whole_file(path, json.dump(2) + "\n");
}

int replay_and_tell(const Options& options, double speed) {
  catch_stop_signals();
  const auto figures = replay(options, speed);
  const Status written = figures ? write_json(options.json, figures.value()) : Status(figures.error());
  if (!written) {
    std::fprintf(stderr, "rfmvo replay: %s\n", written.error().text().c_str());
    return 1;
  }
  const Figures& f = figures.value();
  std::printf("%llu events, %.1f s recorded, replayed in %.2f s (%.2f s CPU): %.1f times real time\n",
              static_cast<unsigned long long>(f.events), f.span_s, f.wall_s, f.cpu_s, f.realtime_factor());
  std::printf("%s\n", options.out.c_str());
  return 0;
}

// Onto the bus, at the recorded times.
Status play_onto_bus(const Options& options) {
  if (const auto log = LogFileReader::open(options.journal); !log) return log.error();
  auto opened = play::BusDoor::create(options.bus);
  if (!opened) return opened.error();
  std::unique_ptr<play::BusDoor> door = std::move(opened).value();
  catch_stop_signals();
  std::fprintf(stderr, "playing %s onto %s%s\n", options.journal.c_str(), options.bus.c_str(),
               door->has_keys() ? "; space: pause, s: step, q: quit" : "");
  const auto figures = play::play({options.journal}, options.play, *door);
  door.reset();  // the terminal as it was
  if (!figures) return figures.error();
  if (!options.json.empty()) {
    const nlohmann::ordered_json json = {{"messages", figures.value().sent}, {"rounds", figures.value().rounds}};
    if (const Status s = write_whole_file(options.json, json.dump(2) + "\n"); !s) return s;
  }
  std::printf("%llu messages\n", static_cast<unsigned long long>(figures.value().sent));
  return Done{};
}

// What the parser cannot say itself.
void check_play(Options& options) {
  if (options.speed == "max") throw CLI::ValidationError("--speed", "expects a number with --bus");
  options.play.speed = speed_of(options.speed);
  options.play.from = Duration::from_seconds(options.start_s);
  if (options.end_s > 0.0) options.play.to = Duration::from_seconds(options.end_s);
  if (options.play.to < options.play.from) throw CLI::ValidationError("--end-s", "is before --start-s");
  try {
    options.play.channels = std::regex(options.channels);
  } catch (const std::regex_error&) {
    throw CLI::ValidationError("--channel", "\"" + options.channels + "\" is no regular expression");
  }
}

void add_bus_options(CLI::App& command, Options& options, CLI::Option* out) {
  auto* bus = command.add_option("--bus", options.bus,
                                 "Play the recorded messages onto this LCM bus instead, at their times (no estimator); "
                                 "without URL: " +
                                     LcmConfig{}.url);
  bus->expected(0, 1)->default_str(LcmConfig{}.url)->type_name("[URL]")->excludes(out);
  const auto only = [&](CLI::Option* option) { option->needs(bus); };
  only(command.add_option("--start-s", options.start_s, "From here on, seconds since the log's first message")
           ->check(CLI::NonNegativeNumber));
  only(command.add_option("--end-s", options.end_s, "Up to here")->check(CLI::PositiveNumber));
  only(command.add_option("--channel", options.channels, "Only channels whose name matches this regular expression"));
  only(command.add_flag("--loop", options.play.loop, "Again and again, until Ctrl-C"));
  only(command.add_flag("--paused", options.play.paused, "Begin paused: space goes on, s sends one message"));
}

}  // namespace

void add_replay_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("replay", "Run the estimator over a recorded or simulated journal");
  command->add_option("journal", options->journal, "Journal (.lcmlog)")->required();
  auto* out = command->add_option("--out", options->out, "Result log to write (.lcmlog)");
  add_bus_options(*command, *options, out);
  command->add_option("--estimator", options->estimator, "joint or paper")->check(CLI::IsMember({"joint", "paper"}));
  command
      ->add_option("--from", options->from,
                   "frames: own visual odometry; poses: recorded camera poses (default: frames if there are any)")
      ->check(CLI::IsMember({"frames", "poses"}));
  command->add_option("--config", options->config, "TOML file over the journal's own configuration");
  command->add_option("--set", options->settings, "One setting: section.key=value")->allow_extra_args(false);
  add_force_option(*command, options->force);
  auto* speed_option = command->add_option(
      "--speed", options->speed, "max, or a factor such as 1.0: paced, and published on the LCM bus; with --bus 1.0");
  command->add_option("--json", options->json, "Write realtime factor and counts to this file");
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, speed_option, &exit_code] {
    if (!options->bus.empty()) {
      if (speed_option->empty()) options->speed = "1.0";
      check_play(*options);
      const Status played = play_onto_bus(*options);
      if (!played) std::fprintf(stderr, "rfmvo replay: %s\n", played.error().text().c_str());
      exit_code = played ? 0 : 1;
      return;
    }
    if (options->out.empty()) throw CLI::RequiredError("--out or --bus");
    const double speed = speed_of(options->speed);
    for (const std::string& setting : options->settings) check_setting(setting);
    exit_code = replay_and_tell(*options, speed);
  });
}

}  // namespace rfmvo
