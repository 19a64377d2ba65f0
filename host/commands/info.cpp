#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "commands/commands.hpp"
#include "commands/json_output.hpp"
#include "edges/toml_files.hpp"
#include "inspect/run_info.hpp"

namespace rfmvo {
namespace {

struct Options {
  std::string log;
  std::string prefix = LcmConfig{}.prefix;
  bool config = false, calibration = false;
  JsonOutput json;
};

// The recorded configuration or calibration as it goes back into --config.
Status print_recorded(const Options& options, const inspect::RunInfo& info) {
  if (!info.start) return Error{ErrorCode::kNotFound, "holds no " + options.prefix + "START", options.log};
  if (!info.start->content) return Error{ErrorCode::kUnsupported, info.start->problem, options.log};
  const Start& start = *info.start->content;
  fmt::print("{}", options.config ? to_toml(start.config) : to_toml(start.calibration));
  return Done{};
}

Status run(const Options& options) {
  const auto info = inspect::read_run_info(options.log, options.prefix);
  if (!info) return info.error();
  if (options.config || options.calibration) return print_recorded(options, info.value());
  if (const Status s = options.json.write(inspect::to_json(info.value(), options.log)); !s) return s;
  if (!options.json.on_stdout()) fmt::print("{}", inspect::to_text(info.value(), options.log));
  std::fflush(stdout);
  return info.value().damage ? Status(*info.value().damage) : Status(Done{});
}

}  // namespace

void add_info_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("info", "What a log holds: channels, rates, gaps, loss, settings, calibration");
  command->add_option("log", options->log, "Journal, result or any LCM log (.lcmlog)")->required();
  options->json.add_to(*command);
  auto* config =
      command->add_flag("--config", options->config, "Print the recorded configuration (TOML), and only that");
  command->add_flag("--calibration", options->calibration, "Print the recorded calibration (TOML), and only that")
      ->excludes(config);
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    const Status status = run(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo info: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
