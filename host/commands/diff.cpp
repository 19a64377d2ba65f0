#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "commands/commands.hpp"
#include "commands/json_output.hpp"
#include "inspect/result_diff.hpp"

namespace rfmvo {
namespace {

constexpr int kTheyDiffer = 3;

struct Options {
  std::string a, b;
  std::string prefix = LcmConfig{}.prefix;
  inspect::Tolerance tolerance;
  JsonOutput json;
};

// True: the same.
Result<bool> run(const Options& options) {
  const auto diff = inspect::diff_results(options.a, options.b, options.prefix);
  if (!diff) return diff.error();
  if (const Status s = options.json.write(inspect::to_json(diff.value(), options.tolerance)); !s) return s.error();
  if (!options.json.on_stdout()) fmt::print("{}", inspect::to_text(diff.value(), options.tolerance));
  return diff.value().same(options.tolerance);
}

}  // namespace

void add_diff_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("diff", "Where two results differ; exit code 3 if they do");
  command->add_option("a", options->a, "Result log (.lcmlog)")->required();
  command->add_option("b", options->b, "Result log (.lcmlog)")->required();
  command
      ->add_option("--tolerance-m", options->tolerance.position_m,
                   "Positions of tags and path this near are the same; default: only the same bytes are")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--tolerance-scale", options->tolerance.scale, "So are scales this near, as a share (0.01: 1 %)")
      ->check(CLI::NonNegativeNumber);
  options->json.add_to(*command);
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    const auto same = run(*options);
    if (same) {
      exit_code = same.value() ? 0 : kTheyDiffer;
      return;
    }
    fmt::print(stderr, "rfmvo diff: {}\n", same.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
