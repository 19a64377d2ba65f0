// When which tag answers on which antenna: the air protocol, as far as its timing matters.
#pragma once

#include <vector>

#include "simulate/radio_link.hpp"

namespace rfmvo::simulate {

struct Singulation {
  double t_s = 0.0;
  std::size_t antenna = 0;
  std::size_t tag = 0;
};

// Rates as measured on a real R420: 70 reads/s of one tag on one antenna, 79/s in all; who answers is
// a weighted draw, so that gaps are heavy-tailed.
[[nodiscard]] std::vector<Singulation> statistical_inventory(const Scene& scene, const RadioLink& link,
                                                             std::uint64_t seed);

// EPC Gen2 rounds: slots, collisions, the Q algorithm, dual target.
[[nodiscard]] std::vector<Singulation> gen2_inventory(const Scene& scene, const RadioLink& link, std::uint64_t seed);

}  // namespace rfmvo::simulate
