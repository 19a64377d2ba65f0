// The subcommands of `rfmvo`. Each adds itself to the parser and, when chosen, runs and sets
// exit_code: 0 done, 1 it failed (one line on stderr says why), 2 the command line is wrong, 3 the answer is no (diff:
// they differ; status: the box is not well).
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
void add_log_command(CLI::App& app, int& exit_code);
void add_status_command(CLI::App& app, int& exit_code);
void add_calibrate_command(CLI::App& app, int& exit_code);
void add_view_command(CLI::App& app, int& exit_code);
void add_info_command(CLI::App& app, int& exit_code);
void add_diff_command(CLI::App& app, int& exit_code);

// Last: it speaks of all others.
void add_manual_commands(CLI::App& app);

}  // namespace rfmvo
