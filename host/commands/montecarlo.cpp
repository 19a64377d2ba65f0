// rfmvo montecarlo: errors over many seeds, as a table and as JSON.
#include <cstdio>
#include <memory>
#include <thread>

#include "commands/commands.hpp"
#include "commands/overwrite.hpp"
#include "commands/progress_line.hpp"
#include "commands/simulation_options.hpp"
#include "commands/whole_file.hpp"
#include "montecarlo/recording.hpp"
#include "montecarlo/statistics_text.hpp"

namespace rfmvo {
namespace {

constexpr std::size_t kMaxSeeds = 100'000;
constexpr std::size_t kMaxJobs = 256;

struct Arguments {
  montecarlo::Options options;
  std::string from = "poses", config, json;
  bool force = false;
};

Status run(Arguments& arguments) {
  if (const Status s = check_free({arguments.json}, arguments.force); !s) return s;
  montecarlo::Options& options = arguments.options;
  options.own_odometry = arguments.from == "frames";
  if (!arguments.config.empty()) {
    auto content = read_whole_file(arguments.config);
    if (!content) return content.error();
    options.config_toml = std::move(content).value();
    options.config_name = arguments.config;
    // A wrong key ends it here, not after the first seed.
    if (const auto config = montecarlo::config_for(Config{}, options); !config) return config.error();
  }
  const auto runs = [&] {
    const ProgressLine line("seeds");
    line.show(0, options.seeds);
    return montecarlo::run(options, [&](std::size_t done, std::size_t all) { line.show(done, all); });
  }();
  if (!runs) return runs.error();
  const montecarlo::Statistics statistics = montecarlo::statistics_of(runs.value(), options);
  // The table first: hours of seeds are not lost to a full disk.
  std::fputs(montecarlo::to_table(runs.value(), statistics).c_str(), stdout);
  if (arguments.json.empty()) return Done{};
  return write_whole_file(arguments.json, montecarlo::to_json(options, runs.value(), statistics));
}

}  // namespace

void add_montecarlo_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  montecarlo::Options& options = arguments->options;
  options.jobs = std::max(1U, std::thread::hardware_concurrency());
  CLI::App* command = app.add_subcommand("montecarlo", "Simulate, estimate and evaluate over many seeds");
  add_simulation_options(*command, options.simulation);
  command->add_option("--seeds", options.seeds, "How many")
      ->check(CLI::Range(std::size_t{1}, kMaxSeeds))
      ->capture_default_str();
  command->add_option("--first-seed", options.first_seed, "The first one")->capture_default_str();
  command->add_option("--jobs", options.jobs, "Seeds at a time; the result does not depend on it")
      ->check(CLI::Range(std::size_t{1}, kMaxJobs))
      ->capture_default_str();
  command->add_option("--estimator", options.estimator, "joint or paper")
      ->check(CLI::IsMember({"joint", "paper"}))
      ->capture_default_str();
  command->add_option("--from", arguments->from, "frames: own visual odometry; poses: simulated drifting camera poses")
      ->check(CLI::IsMember({"frames", "poses"}))
      ->capture_default_str();
  command->add_flag("--known-path", options.known_path, "Estimate once more, with camera poses that do not drift");
  command->add_option("--config", arguments->config, "TOML file over the default configuration")
      ->check(CLI::ExistingFile);
  command->add_option("--json", arguments->json, "Write the numbers to this file, too");
  add_force_option(*command, arguments->force);
  command->callback([arguments, &exit_code] {
    const Status status = run(*arguments);
    if (!status) std::fprintf(stderr, "rfmvo montecarlo: %s\n", status.error().text().c_str());
    exit_code = status ? 0 : 1;
  });
}

}  // namespace rfmvo
