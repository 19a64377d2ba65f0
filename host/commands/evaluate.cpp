#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "commands/commands.hpp"
#include "commands/overwrite.hpp"
#include "commands/whole_file.hpp"
#include "edges/journal.hpp"
#include "evaluate/evaluation_text.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo {
namespace {

struct Options {
  std::string result, truth, json, replay_json;
  bool force = false;
  std::string prefix = LcmConfig{}.prefix;
};

Result<std::optional<double>> realtime_factor(const std::string& path) {
  if (path.empty()) return std::optional<double>();
  const Result<std::string> text = read_whole_file(path);
  if (!text) return text.error();
  return evaluate::realtime_factor_of(text.value(), path);
}

Status run(const Options& options) {
  if (const Status s = check_free({options.json}, options.force); !s) return s;
  const auto estimates = read_estimates(options.result, options.prefix);
  if (!estimates) return estimates.error();
  const auto truth = simulate::read_truth(options.truth);
  if (!truth) return truth.error();
  const auto factor = realtime_factor(options.replay_json);
  if (!factor) return factor.error();
  const auto evaluation = evaluate::evaluate(estimates.value(), truth.value());
  if (!evaluation) return Error{evaluation.error().code, evaluation.error().what, options.result};

  if (!options.json.empty()) {
    Status written = write_whole_file(options.json, evaluate::to_json(evaluation.value(), factor.value()));
    if (!written) return written;
  }
  fmt::print("{}", evaluate::to_table(evaluation.value()));
  if (factor.value()) fmt::print("replay       {:.1f} times real time\n", *factor.value());
  return Done{};
}

}  // namespace

void add_evaluate_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("evaluate", "Compare a result log with the truth");
  command->add_option("result", options->result, "Result log (.lcmlog)")->required();
  command->add_option("--truth", options->truth, "Folder of the truth: tags.csv, trajectory.tum")->required();
  command->add_option("--json", options->json, "Write the numbers to this file, too");
  command->add_option("--replay-json", options->replay_json, "JSON of `rfmvo replay`, for the realtime factor");
  add_force_option(*command, options->force);
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    const Status status = run(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo evaluate: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
