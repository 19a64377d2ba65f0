// rfmvo simulate: a journal as the box would have recorded it, and the truth beside it.
#include <cstdio>
#include <memory>

#include "commands/commands.hpp"
#include "config/config.hpp"
#include "edges/journal.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo {
namespace {

struct Arguments {
  simulate::Options options;
  bool no_frames = false;
  std::string out, truth_directory;
  std::string prefix = LcmConfig{}.prefix;
};

Status run(const Arguments& arguments) {
  auto writer = LogWriter::create(arguments.out, arguments.prefix);
  if (!writer.ok()) return writer.error();
  const std::unique_ptr<LogWriter> log = std::move(writer).value();
  const auto truth = simulate::simulate(arguments.options, [&](const Event& event) { return log->write(event); });
  if (!truth.ok()) return truth.error();
  // The truth first: a journal that is there always has its truth.
  if (Status s = simulate::write_truth(truth.value(), arguments.truth_directory); !s.ok()) return s;
  return log->close();
}

}  // namespace

void add_simulate_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("simulate", "Write the journal of a simulated run, and its truth");
  simulate::Options& options = arguments->options;
  CLI::Option* scene = command->add_option("--scene", options.scene, "What is simulated")
                           ->check(CLI::IsMember(simulate::scene_names()))
                           ->capture_default_str();
  command
      ->add_option("--images", options.images_dir,
                   "Real images with metric truth (images/, times.txt, groundtruth.txt, calib.txt); tags and antennas "
                   "are simulated")
      ->check(CLI::ExistingDirectory)
      ->excludes(scene);
  command->add_option("--seed", options.seed, "Same seed, same bytes")->capture_default_str();
  command->add_option("--out", arguments->out, "Journal to write (.lcmlog)")->required();
  command->add_option("--truth", arguments->truth_directory, "Folder for the truth")->required();
  command->add_option("--vo-class", options.vo_class, "Drift of the camera poses in the journal")
      ->check(CLI::IsMember(simulate::vo_class_names()))
      ->capture_default_str();
  command->add_option("--reader-delay-s", options.reader_delay_s, "Read stamps are late by this much")
      ->check(CLI::Range(-1.0, 1.0))
      ->capture_default_str();
  command->add_flag("--no-frames", arguments->no_frames, "Camera poses only, no images");
  command->add_option("--prefix", arguments->prefix, "Of the LCM channels")->capture_default_str();
  command->callback([arguments, &exit_code] {
    arguments->options.frames = !arguments->no_frames;
    const Status status = run(*arguments);
    if (!status.ok()) std::fprintf(stderr, "rfmvo simulate: %s\n", status.error().text().c_str());
    exit_code = status.ok() ? 0 : 1;
  });
}

}  // namespace rfmvo
