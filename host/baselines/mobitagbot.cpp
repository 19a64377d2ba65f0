#include "baselines/mobitagbot.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/units.hpp"

namespace rfmvo::baselines {
namespace {

// Reads [begin, end) of one antenna.
struct Location {
  std::size_t begin = 0, end = 0;
  double spread_rad = 0.0;  // 0: too few channels to tell
};

double spread_rad(const Eigen::ArrayXf& turns) {
  std::complex<double> sum;
  for (const float t : turns) sum += std::polar(1.0, kTwoPi * t);
  const double mean = std::arg(sum);
  double squares = 0.0;
  for (const float t : turns) {
    const double off = std::remainder(kTwoPi * t - mean, kTwoPi);
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(turns.size()));
}

std::vector<Location> locations_of(const std::vector<KnownRead>& reads, const Eigen::ArrayXf& turns) {
  std::vector<Location> locations;
  for (std::size_t begin = 0, end = 0; begin < reads.size(); begin = end) {
    std::set<std::uint32_t> channels;
    for (end = begin; end < reads.size(); ++end) {
      if ((reads[end].p_W_A_m - reads[begin].p_W_A_m).norm() > kLocationLength_m) break;
      channels.insert(reads[end].frequency_hz);
    }
    Location location{begin, end, 0.0};
    if (channels.size() >= kMinChannels)
      location.spread_rad =
          spread_rad(turns.segment(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin)));
    locations.push_back(location);
  }
  return locations;
}

}  // namespace

MobiTagbot::MobiTagbot(std::span<const KnownRead> reads)
    : phasor_([](double angle_rad) { return std::polar(1.0, angle_rad); }) {
  for (const auto& group : by_group(reads))
    if (!group.empty()) antennas_.emplace_back(group);
}

double MobiTagbot::likelihood(const Eigen::Vector3d& p_W_X_m) {
  double likelihood = 0.0;
  for (Residuals& antenna : antennas_) {
    std::complex<float> sum;
    for (const float turns : antenna.at(p_W_X_m)) sum += phasor_(turns);
    likelihood += double{std::abs(sum)};
  }
  return likelihood;
}

std::vector<bool> clear_of_multipath(std::span<const KnownRead> reads, const Eigen::Vector3d& p_W_X_m) {
  std::vector<bool> clear(reads.size(), true);
  std::vector<std::vector<std::size_t>> places;  // of the reads of a group, among all
  for (std::size_t i = 0; i < reads.size(); ++i) {
    const auto group = static_cast<std::size_t>(reads[i].group);
    if (group >= places.size()) places.resize(group + 1);
    places[group].push_back(i);
  }
  const auto groups = by_group(reads);
  struct Suspect {
    double spread_rad;
    std::size_t group;
    Location location;
  };
  std::vector<Suspect> suspects;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].empty()) continue;
    Residuals residuals(groups[g]);
    for (const Location& location : locations_of(groups[g], residuals.at(p_W_X_m)))
      if (location.spread_rad > kMultipath_rad) suspects.push_back({location.spread_rad, g, location});
  }
  std::stable_sort(suspects.begin(), suspects.end(),
                   [](const Suspect& a, const Suspect& b) { return a.spread_rad > b.spread_rad; });
  std::size_t excluded = 0;
  for (const Suspect& suspect : suspects) {
    const std::size_t more = suspect.location.end - suspect.location.begin;
    if (2 * (excluded + more) > reads.size()) break;
    excluded += more;
    for (std::size_t i = suspect.location.begin; i < suspect.location.end; ++i) clear[places[suspect.group][i]] = false;
  }
  return clear;
}

HologramPeak locate_by_mobitagbot(std::span<const KnownRead> reads, const Region& region) {
  const auto hologram = [&](std::span<const KnownRead> some) {
    MobiTagbot tagbot(some);
    return likeliest_cell(region, [&](const Eigen::Vector3d& p) { return tagbot.likelihood(p); });
  };
  const HologramPeak first = hologram(reads);
  const std::vector<bool> clear = clear_of_multipath(reads, first.p_W_X_m);
  if (std::all_of(clear.begin(), clear.end(), [](bool c) { return c; })) return first;
  std::vector<KnownRead> kept;
  for (std::size_t i = 0; i < reads.size(); ++i)
    if (clear[i]) kept.push_back(reads[i]);
  return hologram(kept);
}

}  // namespace rfmvo::baselines
