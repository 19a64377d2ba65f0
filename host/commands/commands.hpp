// The subcommands of `rfmvo`. Each adds itself to the parser and, when chosen, runs and sets
// exit_code: 0 done, 1 it failed (one line on stderr says why), 2 the command line is wrong.
#pragma once

#include <CLI/CLI.hpp>

namespace rfmvo {

void add_simulate_command(CLI::App& app, int& exit_code);
void add_replay_command(CLI::App& app, int& exit_code);
void add_evaluate_command(CLI::App& app, int& exit_code);
void add_export_command(CLI::App& app, int& exit_code);
void add_report_command(CLI::App& app, int& exit_code);
void add_montecarlo_command(CLI::App& app, int& exit_code);
void add_bound_command(CLI::App& app, int& exit_code);
void add_reproduce_command(CLI::App& app, int& exit_code);
void add_vo_command(CLI::App& app, int& exit_code);
void add_reader_sim_command(CLI::App& app, int& exit_code);
void add_configure_command(CLI::App& app, int& exit_code);

}  // namespace rfmvo
