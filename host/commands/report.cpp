#include "report/report.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "commands/commands.hpp"
#include "commands/overwrite.hpp"
#include "commands/whole_file.hpp"
#include "edges/journal.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo {
namespace {

struct Options {
  std::string result, truth, journal, out;
  bool force = false;

  std::string prefix = LcmConfig{}.prefix;
};

Result<std::optional<simulate::Truth>> truth_of(const std::string& directory) {
  if (directory.empty()) return std::optional<simulate::Truth>();
  auto truth = simulate::read_truth(directory);
  if (!truth) return truth.error();
  return std::optional(std::move(truth).value());
}

Status run(const Options& options) {
  if (const Status s = check_free({options.out}, options.force); !s) return s;
  const auto estimates = read_estimates(options.result, options.prefix);
  if (!estimates) return estimates.error();
  const auto truth = truth_of(options.truth);
  if (!truth) return truth.error();
  const std::string name = std::filesystem::path(options.result).filename().string();
  std::optional<report::JournalData> journal;
  if (!options.journal.empty()) {
    auto read = report::read_journal_data(options.journal, options.prefix, evaluate::last_of(estimates.value()));
    if (!read) return read.error();
    journal = std::move(read).value();
  }
  const auto page = report::make_report(estimates.value(), truth.value(), name, std::move(journal));
  if (!page) return page.error();
  return write_whole_file(options.out, page.value());
}

}  // namespace

void add_report_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("report", "Write one HTML page about a result log (needs gnuplot)");
  command->add_option("result", options->result, "Result log (.lcmlog)")->required();
  command->add_option("--truth", options->truth, "Folder of the truth: tags.csv, trajectory.tum");
  command->add_option("--journal", options->journal, "The journal of that result: adds reads, phase residuals, faults");
  command->add_option("--out", options->out, "The page (.html)")->required();
  add_force_option(*command, options->force);
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    const Status status = run(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo report: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
