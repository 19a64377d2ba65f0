// Options that say what is simulated: the same for every subcommand that simulates.
#pragma once

#include <CLI/CLI.hpp>

#include "simulate/simulation.hpp"

namespace rfmvo {

// All but --seed. `options` must outlive the parsing.
void add_simulation_options(CLI::App& command, simulate::Options& options);

}  // namespace rfmvo
