#include <algorithm>
#include <cmath>

#include "simulate/inventory.hpp"
#include "simulate/random.hpp"
#include "simulate/reader.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kOneTag = 70.0 / 79.0;   // its rate against that of many; measured, DESIGN 2.8
constexpr double kShortestGap_s = 0.004;  // one Gen2 singulation, Miller 4
constexpr double kDwell_s = 0.030;        // of the reader on one antenna

}  // namespace

std::vector<Singulation> statistical_inventory(const Scene& scene, const RadioLink& link, std::uint64_t seed) {
  Random random(seed, "inventory");
  const ChannelPlan channels(seed);
  const std::size_t antennas = scene.calibration.antennas.size();
  std::vector<Singulation> reads;
  std::vector<double> cumulative(scene.tags.size());
  double t_s = scene.start_s();
  while (t_s < scene.end_s()) {
    const auto dwell = static_cast<std::int64_t>(std::floor(t_s / kDwell_s));
    const std::size_t antenna = static_cast<std::size_t>(dwell) % antennas;
    std::size_t readable = 0;
    double total = 0.0;
    for (std::size_t tag = 0; tag < scene.tags.size(); ++tag) {
      const LinkState state = link(t_s, antenna, tag, channels.frequency_hz(t_s));
      if (state.readable) ++readable;
      total += state.readable ? state.weight : 0.0;
      cumulative[tag] = total;
    }
    if (readable == 0) {
      t_s = static_cast<double>(dwell + 1) * kDwell_s + 1e-9;  // nobody answers: the next antenna
      continue;
    }
    const double pick = random.uniform() * total;
    const auto winner = std::upper_bound(cumulative.begin(), cumulative.end(), pick) - cumulative.begin();
    reads.push_back({t_s, antenna, static_cast<std::size_t>(winner)});
    const double mean_gap_s = 1.0 / ((readable == 1 ? kOneTag : 1.0) * scene.read_rate_hz);
    const double shortest_s = std::min(kShortestGap_s, 0.5 * mean_gap_s);
    t_s += shortest_s + (mean_gap_s - shortest_s) * random.exponential();
  }
  return reads;
}

}  // namespace rfmvo::simulate
