#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <vector>

#include "commands/commands.hpp"
#include "commands/export_text.hpp"
#include "commands/whole_file.hpp"
#include "edges/journal.hpp"

namespace rfmvo {
namespace {

struct Options {
  std::string result, tum, tags_csv;
  std::string prefix = LcmConfig{}.prefix;
};

Status run(const Options& options) {
  const auto estimates = read_estimates(options.result, options.prefix);
  if (!estimates) return estimates.error();
  const evaluate::LastEstimates last = evaluate::last_of(estimates.value());
  if (!options.tum.empty() && last.trajectories.empty()) {
    return Error{ErrorCode::kNotFound, "no metric path in this log", options.result};
  }

  // Both are written before either gets its name.
  std::vector<WholeFile> files;
  const auto stage = [&](const std::string& path, const std::string& content) -> Status {
    if (path.empty()) return Done{};
    auto file = WholeFile::stage(path, content);
    if (!file) return file.error();
    files.push_back(std::move(file).value());
    return Done{};
  };
  if (Status s = stage(options.tum, to_tum(last)); !s) return s;
  if (Status s = stage(options.tags_csv, to_tags_csv(last)); !s) return s;
  for (WholeFile& file : files) {
    if (Status s = file.commit(); !s) return s;
  }
  return Done{};
}

}  // namespace

void add_export_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("export", "Write path and tags of a result log as TUM and CSV");
  command->add_option("result", options->result, "Result log (.lcmlog)")->required();
  command->add_option("--tum", options->tum, "Camera path: t tx ty tz qx qy qz qw");
  command->add_option("--tags-csv", options->tags_csv, "Tags with position and covariance");
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    if (options->tum.empty() && options->tags_csv.empty()) {
      fmt::print(stderr, "rfmvo export: nothing to do: give --tum or --tags-csv\n");
      exit_code = 2;
      return;
    }
    const Status status = run(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo export: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
