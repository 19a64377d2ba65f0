#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <vector>

#include "commands/commands.hpp"
#include "commands/export_text.hpp"
#include "commands/overwrite.hpp"
#include "commands/progress_line.hpp"
#include "commands/whole_file.hpp"
#include "edges/journal.hpp"
#include "mcap/export_mcap.hpp"

namespace rfmvo {
namespace {

struct Options {
  std::string result, tum, tags_csv, tags_json, mcap, frames;
  bool force = false;
  std::string prefix = LcmConfig{}.prefix;
};

Status export_texts(const Options& options) {
  const auto estimates = read_estimates(options.result, options.prefix);
  if (!estimates) return estimates.error();
  const evaluate::LastEstimates last = evaluate::last_of(estimates.value());
  if (!options.tum.empty() && last.trajectories.empty()) {
    return Error{ErrorCode::kNotFound, "no metric path in this log", options.result};
  }

  // All are written before any gets its name.
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
  if (Status s = stage(options.tags_json, to_tags_json(last)); !s) return s;
  for (WholeFile& file : files) {
    if (Status s = file.commit(); !s) return s;
  }
  return Done{};
}

// Pictures are in the journal, positions in its result.
Status export_mcap(const Options& options) {
  std::vector<std::string> logs = {options.result};
  if (!options.frames.empty()) logs.insert(logs.begin(), options.frames);
  const ProgressLine line("");
  const auto figures = mcap::export_mcap(logs, options.prefix, options.mcap, [&](std::int64_t bytes) {
    line.say(fmt::format("{} MB read", bytes / 1'000'000));
  });
  if (!figures) return figures.error();
  fmt::print("{}: {} messages, {} pictures, {} tags\n", options.mcap, figures.value().messages, figures.value().images,
             figures.value().tags);
  return Done{};
}

Status run(const Options& options) {
  const Status free = check_free({options.tum, options.tags_csv, options.tags_json, options.mcap}, options.force);
  if (!free) return free;
  if (!options.tum.empty() || !options.tags_csv.empty() || !options.tags_json.empty())
    if (Status s = export_texts(options); !s) return s;
  return options.mcap.empty() ? Status(Done{}) : export_mcap(options);
}

}  // namespace

void add_export_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("export", "Write path and tags of a result log in the formats of others");
  command->add_option("result", options->result, "Result log (.lcmlog)")->required();
  command->add_option("--tum", options->tum, "Camera path: t tx ty tz qx qy qz qw");
  command->add_option("--tags-csv", options->tags_csv, "Tags with position and covariance");
  command->add_option("--tags-json", options->tags_json, "The same as features, as GeoJSON has them, in metres of W");
  auto* mcap = command->add_option("--mcap", options->mcap,
                                   "Path, tags with ellipsoids, pictures and faults for Foxglove (MCAP)");
  command->add_option("--frames", options->frames, "Journal with the pictures, for --mcap")->needs(mcap);
  add_force_option(*command, options->force);
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    if (options->tum.empty() && options->tags_csv.empty() && options->tags_json.empty() && options->mcap.empty())
      throw CLI::RequiredError("--tum, --tags-csv, --tags-json or --mcap");
    const Status status = run(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo export: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
