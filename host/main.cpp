// rfmvo: the tool on the desk. Each subcommand is in commands/.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "commands/commands.hpp"

int main(int argc, char** argv) {
  int exit_code = 0;
  CLI::App app("Record, replay, look at, simulate and evaluate runs of the RF and visual-odometry box", "rfmvo");
  app.set_version_flag("--version", "rfmvo " RFMVO_VERSION);
  app.require_subcommand(1);
  rfmvo::add_simulate_command(app, exit_code);
  rfmvo::add_replay_command(app, exit_code);
  rfmvo::add_log_command(app, exit_code);
  rfmvo::add_status_command(app, exit_code);
  rfmvo::add_calibrate_command(app, exit_code);
  rfmvo::add_view_command(app, exit_code);
  rfmvo::add_info_command(app, exit_code);
  rfmvo::add_diff_command(app, exit_code);
  rfmvo::add_evaluate_command(app, exit_code);
  rfmvo::add_export_command(app, exit_code);
  rfmvo::add_report_command(app, exit_code);
  rfmvo::add_montecarlo_command(app, exit_code);
  rfmvo::add_bound_command(app, exit_code);
  rfmvo::add_reproduce_command(app, exit_code);
  rfmvo::add_vo_command(app, exit_code);
  rfmvo::add_reader_sim_command(app, exit_code);
  rfmvo::add_configure_command(app, exit_code);
  rfmvo::add_manual_commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "rfmvo: %s\n", error.what());
    return 2;
  }
  return exit_code;
}
