// rfmvo bound: how well a simulated run could be solved at best.
#include <cstdio>
#include <memory>

#include "bound/bound_text.hpp"
#include "commands/commands.hpp"
#include "commands/overwrite.hpp"
#include "commands/simulation_options.hpp"
#include "commands/whole_file.hpp"

namespace rfmvo {
namespace {

struct Arguments {
  simulate::Options simulation;
  bound::Settings settings;
  std::optional<double> time_offset_sigma_s;
  bound::ReadChoice reads;
  std::string json;
  bool force = false;
};

Status run(const Arguments& arguments) {
  if (const Status s = check_free({arguments.json}, arguments.force); !s) return s;
  const auto world = bound::world_of(arguments.simulation, arguments.reads);
  if (!world) return world.error();
  bound::Settings unknown = arguments.settings, known = arguments.settings;
  unknown.time_offset_sigma_s =
      arguments.time_offset_sigma_s.value_or(bound::settings_for(arguments.simulation).time_offset_sigma_s);
  known.known_path = true;
  bound::RunBounds bounds{bound::bound_of(world.value(), unknown), bound::bound_of(world.value(), known), {}};
  bounds.lobes = bound::lobes_of(world.value(), bounds.unknown);
  std::fputs(bound::to_table(bounds).c_str(), stdout);
  return arguments.json.empty() ? Done{} : write_whole_file(arguments.json, bound::to_json(bounds));
}

void add_model_options(CLI::App& command, Arguments& arguments) {
  bound::Settings& settings = arguments.settings;
  command.add_flag("--free-offsets", settings.free_offsets, "An offset per tag and port, nothing shared");
  command.add_flag("--known-lever-arms", settings.known_lever_arms, "Lever arms are known exactly");
  command
      .add_option("--time-offset-sigma-s", arguments.time_offset_sigma_s,
                  "What is not known of camera against reader, 1 sigma (default: --reader-delay-s)")
      ->check(CLI::Range(0.0, 1.0));
  command
      .add_option("--white-rad", arguments.reads.white_rad, "White phase noise of every read, instead of the link's")
      ->check(CLI::Range(1e-4, 10.0));
  command
      .add_option("--read-spacing-m", arguments.reads.read_spacing_m,
                  "Every tag in the beam read on every port this often along the way, instead of the inventory")
      ->check(CLI::Range(0.001, 10.0));
}

}  // namespace

void add_bound_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("bound", "Cramer-Rao bound of a simulated run");
  add_simulation_options(*command, arguments->simulation);
  command->add_option("--seed", arguments->simulation.seed, "Of the simulated run")->capture_default_str();
  add_model_options(*command, *arguments);
  command->add_option("--json", arguments->json, "Write the numbers to this file, too");
  add_force_option(*command, arguments->force);
  command->callback([arguments, &exit_code] {
    const Status status = run(*arguments);
    if (!status) std::fprintf(stderr, "rfmvo bound: %s\n", status.error().text().c_str());
    exit_code = status ? 0 : 1;
  });
}

}  // namespace rfmvo
