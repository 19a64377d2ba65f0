// Which tag is read when on which antenna, and the link at that moment: all of a run but the reader.
#pragma once

#include "simulate/inventory.hpp"

namespace rfmvo::simulate {

struct RadioRun {
  RadioLink link;
  std::vector<Singulation> singulations;  // in time order
};

// Statistical or physical, as the scene says.
[[nodiscard]] RadioRun make_radio_run(const Scene& scene, std::uint64_t seed);

// What the reader reports of it, with the options' stress; times are `epoch` plus the scene's.
[[nodiscard]] std::vector<TagRead> make_reads(const Scene& scene, const Options& options, DeviceTime epoch);

}  // namespace rfmvo::simulate
