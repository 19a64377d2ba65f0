// rfmvo simulate: a journal as the box would have recorded it, and the truth beside it.
#include <cstdio>
#include <memory>

#include "commands/commands.hpp"
#include "commands/frame_folder.hpp"
#include "commands/overwrite.hpp"
#include "commands/progress_line.hpp"
#include "commands/simulation_options.hpp"
#include "config/config.hpp"
#include "edges/journal.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo {
namespace {

struct Arguments {
  simulate::Options options;
  bool no_frames = false, force = false;
  double start_at_s = 0.0;  // since 1970; 0: the simulation's own
  std::string out, truth_directory, frames_directory, frames_to;
  std::string prefix = LcmConfig{}.prefix;
};

Status run(const Arguments& arguments) {
  if (const Status s = check_free({arguments.out}, arguments.force); !s) return s;
  if (!arguments.frames_directory.empty()) {
    const Status s = simulate::write_image_folder(arguments.options, arguments.frames_directory);
    if (!s.ok() || arguments.out.empty()) return s;
  }
  auto writer = LogWriter::create(arguments.out, arguments.prefix);
  if (!writer.ok()) return writer.error();
  const std::unique_ptr<LogWriter> log = std::move(writer).value();
  std::optional<FrameFolder> folder;
  if (!arguments.frames_to.empty()) {
    auto made = FrameFolder::create(arguments.frames_to);
    if (!made.ok()) return made.error();
    folder = std::move(made).value();
  }
  const ProgressLine line("");
  std::optional<DeviceTime> first;
  const auto truth = simulate::simulate(arguments.options, [&](const Event& event) -> Status {
    if (!first) first = time_of(event);
    line.say(std::to_string((time_of(event) - *first).ns / 1'000'000'000) + " s simulated");
    if (folder)
      if (Status s = folder->write(event); !s.ok()) return s;
    return log->write(event);
  });
  if (!truth.ok()) return truth.error();
  if (folder)
    if (Status s = folder->close(); !s.ok()) return s;
  // The truth first: a journal that is there always has its truth.
  if (Status s = simulate::write_truth(truth.value(), arguments.truth_directory); !s.ok()) return s;
  return log->close();
}

}  // namespace

void add_simulate_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("simulate", "Write the journal of a simulated run, and its truth");
  add_simulation_options(*command, arguments->options);
  command->add_option("--seed", arguments->options.seed, "Same seed, same bytes")->capture_default_str();
  CLI::Option* out = command->add_option("--out", arguments->out, "Journal to write (.lcmlog)");
  CLI::Option* truth = command->add_option("--truth", arguments->truth_directory, "Folder for the truth");
  out->needs(truth);
  truth->needs(out);
  command->add_option("--frames", arguments->frames_directory,
                      "Write the pictures as a folder: images/, times.txt, calib.txt, groundtruth.txt");
  command->add_option("--start-at", arguments->start_at_s, "Time of the first frame, seconds since 1970")
      ->check(CLI::Range(1.0, 9e9));
  command
      ->add_option("--frames-to", arguments->frames_to,
                   "Write the frames to this folder too, with calibration and a configuration that plays them live")
      ->needs(out);
  command->add_flag("--no-frames", arguments->no_frames, "Camera poses only, no images");
  add_force_option(*command, arguments->force);
  command->add_option("--prefix", arguments->prefix, "Of the LCM channels")->capture_default_str();
  command->callback([arguments, &exit_code] {
    if (arguments->out.empty() && arguments->frames_directory.empty())
      throw CLI::RequiredError("--out and --truth, or --frames");
    arguments->options.frames = !arguments->no_frames;
    if (arguments->start_at_s > 0.0)
      arguments->options.start = DeviceTime{Duration::from_seconds(arguments->start_at_s).ns};
    const Status status = run(*arguments);
    if (!status.ok()) std::fprintf(stderr, "rfmvo simulate: %s\n", status.error().text().c_str());
    exit_code = status.ok() ? 0 : 1;
  });
}

}  // namespace rfmvo
