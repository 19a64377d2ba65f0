// What the spherical-wave kernel replaced: one block of cells in float, as vectorised by the compiler.
#pragma once

#include <span>

#include "kernels/spherical_wave_spectrum.hpp"

namespace rfmvo::bench {

// Reads of groups 0 to 7.
[[nodiscard]] BlockPower float_block_power(std::span<const SphericalWaveRead> reads, const CellBlock& block);

}  // namespace rfmvo::bench
