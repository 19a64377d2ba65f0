// rfmvo log: the bus into a file.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/json_output.hpp"
#include "commands/progress_line.hpp"
#include "config/config.hpp"
#include "edges/stop_signal.hpp"
#include "record/recorder.hpp"

namespace rfmvo {
namespace {

constexpr double kMB = 1e6;

struct Options {
  record::SeriesSettings series;
  record::RecorderSettings recorder;
  std::string url = LcmConfig{}.url;
  std::string channels = ".*";
  double split_mb = 0.0, disk_quota_mb = 0.0, flush_interval_s = 0.5, duration_s = 0.0;
  JsonOutput json;
};

std::string loss_text(const BusLoss& loss) {
  if (!loss.counted) return "loss unknown: this bus has no sequence numbers";
  std::string text = fmt::format("{} lost", loss.messages);
  if (loss.dropped_here > 0)
    text += fmt::format(" ({} datagrams because this machine's receive buffer was full: sysctl net.core.rmem_max)",
                        loss.dropped_here);
  return text;
}

void print_summary(const record::RecorderFigures& f, const record::LogSeries& log) {
  for (const auto& [channel, count] : f.channels) {
    const auto lost = f.sequences.lost(channel);
    fmt::print("{:<24} {:>9} messages {:>10.2f} MB{}\n", channel, count.messages,
               static_cast<double>(count.bytes) / kMB,
               lost && *lost > 0 ? fmt::format("  {} missing by its own counter", *lost) : "");
  }
  fmt::print("{}: {:.1f} s, {} messages, {:.2f} MB in {} file{}; {}\n", log.path(), f.length.seconds(), f.messages,
             static_cast<double>(log.bytes()) / kMB, log.files(), log.files() == 1 ? "" : "s", loss_text(f.loss));
}

std::string to_json(const record::RecorderFigures& f, const record::LogSeries& log) {
  nlohmann::ordered_json json{{"file", log.path()},
                              {"files", log.files()},
                              {"duration_s", f.length.seconds()},
                              {"messages", f.messages},
                              {"bytes", log.bytes()},
                              {"loss_counted", f.loss.counted},
                              {"lost", f.loss.messages},
                              {"dropped_here", f.loss.dropped_here}};
  json["channels"] = nlohmann::ordered_json::object();
  for (const auto& [channel, count] : f.channels) {
    auto& entry = json["channels"][channel] = {{"messages", count.messages}, {"bytes", count.bytes}};
    if (const auto lost = f.sequences.lost(channel)) entry["lost"] = *lost;
  }
  return json.dump(2) + "\n";
}

// What was recorded is told in any case.
Status run(const Options& options) {
  auto bus = open_bus_listener(options.url);
  if (!bus) return bus.error();
  auto opened = record::LogSeries::create(options.series);
  if (!opened) return opened.error();
  record::LogSeries& log = *opened.value();
  catch_stop_signals();
  fmt::print(stderr, "recording {} into {}; Ctrl-C ends it\n", options.url, log.path());
  record::RecorderFigures figures;
  Status recorded = Done{};
  {
    const ProgressLine line("");
    recorded = record::record(
        *bus.value(), log, options.recorder, stop_requested,
        [&](const record::RecorderFigures& f) {
          line.say(fmt::format("{:.0f} s, {} messages, {:.1f} MB, {} lost", f.length.seconds(), f.messages,
                               static_cast<double>(log.bytes()) / kMB, f.loss.messages));
        },
        figures);
  }
  if (const Status s = options.json.write(to_json(figures, log)); !s) return s;
  if (!options.json.on_stdout()) print_summary(figures, log);
  return recorded;
}

}  // namespace

void add_log_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("log", "Record what is said on the LCM bus, and count what was lost");
  command->add_option("out", options->series.path, "Log to write (.lcmlog)")->required();
  command->add_option("--url", options->url, "LCM bus")->capture_default_str();
  command->add_option("--channel", options->channels, "Only channels whose name matches this regular expression")
      ->capture_default_str();
  command->add_flag("--invert", options->recorder.invert, "Only channels that do not match");
  command->add_option("--split-mb", options->split_mb, "Begin a new file, OUT-00002 and so on, beyond this size")
      ->check(CLI::Range(0.001, 1e9));
  command->add_option("--rotate", options->series.keep_files, "Keep so many files of the series; the oldest go")
      ->check(CLI::PositiveNumber)
      ->needs("--split-mb");
  command
      ->add_option("--disk-quota-mb", options->disk_quota_mb,
                   "Leave this much of the disk free: the oldest files of a series go, then recording ends")
      ->check(CLI::Range(0.001, 1e9));
  command
      ->add_option("--flush-interval-s", options->flush_interval_s,
                   "Onto the disk this often; a power cut costs as much")
      ->check(CLI::Range(0.001, 3600.0))
      ->capture_default_str();
  command->add_option("--duration-s", options->duration_s, "End after this time; default: at Ctrl-C")
      ->check(CLI::PositiveNumber);
  command->add_flag("--force", options->series.overwrite, "Overwrite a recording of this name");
  options->json.add_to(*command, &options->series.overwrite);
  command->callback([options, &exit_code] {
    try {
      options->recorder.channels = std::regex(options->channels);
    } catch (const std::regex_error&) {
      throw CLI::ValidationError("--channel", "\"" + options->channels + "\" is no regular expression");
    }
    options->series.split_bytes = static_cast<std::uint64_t>(options->split_mb * kMB);
    options->series.spare_disk_bytes = static_cast<std::uint64_t>(options->disk_quota_mb * kMB);
    options->recorder.flush_interval = Duration::from_seconds(options->flush_interval_s);
    options->recorder.length = Duration::from_seconds(options->duration_s);
    const Status status = run(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo log: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
