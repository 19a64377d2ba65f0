// rfmvo reproduce: the paper's evaluation as one page, and the numbers behind it.
#include <cstdio>
#include <filesystem>
#include <memory>

#include "commands/commands.hpp"
#include "commands/progress_line.hpp"
#include "commands/whole_file.hpp"
#include "reproduce/json.hpp"
#include "reproduce/page.hpp"

namespace rfmvo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxRuns = 10'000, kMaxJobs = 256, kMaxTags = 1000;

struct Arguments {
  reproduce::Options options;
  std::string out = "reproduction";
};

Status run(const Arguments& arguments) {
  const fs::path folder = arguments.out;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error{ErrorCode::kUnwritable, error.message(), arguments.out};
  const auto results = [&] {
    const ProgressLine line("runs and settings");
    return reproduce::reproduce(arguments.options, [&](std::size_t done, std::size_t all) { line.show(done, all); });
  }();
  if (!results) return results.error();
  // The numbers first: they are not lost where gnuplot is missing.
  const fs::path json = folder / "reproduction.json", page_file = folder / "reproduction.html";
  const Status written = write_whole_file(json.string(), reproduce::to_json(arguments.options, results.value()));
  if (!written) return written;
  const auto page = reproduce::make_page(results.value());
  if (!page) return page.error();
  if (const Status s = write_whole_file(page_file.string(), page.value()); !s) return s;
  std::printf("page: %s\nnumbers: %s\n", page_file.c_str(), json.c_str());
  return Done{};
}

}  // namespace

void add_reproduce_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  reproduce::Options& options = arguments->options;
  CLI::App* command = app.add_subcommand("reproduce", "The paper's evaluation: figures 7 to 13 and run times");
  command->add_option("--out", arguments->out, "Folder for reproduction.html and reproduction.json")
      ->capture_default_str();
  command->add_option("--runs", options.runs, "Simulated runs")
      ->check(CLI::Range(std::size_t{1}, kMaxRuns))
      ->capture_default_str();
  command->add_option("--first-seed", options.first_seed, "Seed of the first run")->capture_default_str();
  command->add_option("--sweep-runs", options.sweep_runs, "Of these for figures 11 to 13")
      ->check(CLI::Range(std::size_t{0}, kMaxRuns))
      ->capture_default_str();
  command->add_option("--tags", options.tags, "Number of tags (default: the scene's eight)")
      ->check(CLI::Range(std::size_t{1}, kMaxTags));
  command->add_option("--jobs", options.jobs, "Runs at a time; the results do not depend on it")
      ->check(CLI::Range(std::size_t{1}, kMaxJobs))
      ->capture_default_str();
  command
      ->add_option("--images", options.images_dir,
                   "Once more with the product's odometry on real images with metric truth (images/, times.txt, "
                   "groundtruth.txt, calib.txt)")
      ->check(CLI::ExistingDirectory);
  command->callback([arguments, &exit_code] {
    const Status status = run(*arguments);
    if (!status) std::fprintf(stderr, "rfmvo reproduce: %s\n", status.error().text().c_str());
    exit_code = status ? 0 : 1;
  });
}

}  // namespace rfmvo
