#include "estimator/port_offset_scan.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace rfmvo {
namespace {

constexpr int kSteps = 36;  // of a turn

double power_at(const TagPlaces& tag, std::size_t place, const std::vector<double>& offset_rad) {
  std::complex<double> sum;
  for (std::size_t p = 0; p < offset_rad.size(); ++p) sum += tag.phasor[place][p] * std::polar(1.0, -offset_rad[p]);
  return std::norm(sum) / tag.reads;
}

double power_of(const std::vector<TagPlaces>& tags, const std::vector<double>& offset_rad) {
  double power = 0.0;
  for (const TagPlaces& tag : tags)
    if (!tag.p_W_X.empty()) power += power_at(tag, best_place(tag, offset_rad), offset_rad);
  return power;
}

// All steps of one port's offset, the others held.
std::vector<double> sweep(const std::vector<TagPlaces>& tags, std::vector<double> offset_rad, std::size_t port) {
  std::vector<double> power;
  for (int i = 0; i < kSteps; ++i) {
    offset_rad[port] = kTwoPi * i / kSteps;
    power.push_back(power_of(tags, offset_rad));
  }
  return power;
}

}  // namespace

TagPlaces phasors_at(const std::vector<JointRead>& reads, const JointState& state,
                     std::vector<Eigen::Vector3d> places) {
  TagPlaces tag;
  tag.p_W_X = std::move(places);
  tag.reads = static_cast<double>(reads.size());
  struct Seen {
    Eigen::Vector3d p_W_A;
    double wavenumber_rad_m, phase_rad;  // measured, less what the cable adds
    std::size_t port;
  };
  std::vector<Seen> seen;
  for (const JointRead& read : reads) {
    const ReadStates s = states_at(read, state, TagState{});
    seen.push_back({antenna_position(read.geometry, s), read.geometry.wavenumber_rad_m,
                    read.phase_rad - read.geometry.frequency_term_rad_m * s.electrical_length_m,
                    static_cast<std::size_t>(read.port)});
  }
  for (const Eigen::Vector3d& place : tag.p_W_X) {
    std::vector<std::complex<double>>& phasor = tag.phasor.emplace_back(state.ports.size());
    for (const Seen& s : seen)
      phasor[s.port] += std::polar(1.0, s.phase_rad - s.wavenumber_rad_m * (s.p_W_A - place).norm());
  }
  return tag;
}

std::size_t best_place(const TagPlaces& tag, const std::vector<double>& offset_rad) {
  std::size_t best = 0;
  double best_power = -1.0;
  for (std::size_t k = 0; k < tag.p_W_X.size(); ++k) {
    const double power = power_at(tag, k, offset_rad);
    if (power > best_power) {
      best_power = power;
      best = k;
    }
  }
  return best;
}

std::vector<PortOffsets> scan_port_offsets(const std::vector<TagPlaces>& tags, std::size_t ports, std::size_t count) {
  std::vector<PortOffsets> found;
  const std::vector<double> zero(ports, 0.0);
  if (ports < 2) return {{zero, power_of(tags, zero)}};
  // The second port's maxima; every further port then one by one, and once more each.
  const std::vector<double> power = sweep(tags, zero, 1);
  for (int i = 0; i < kSteps; ++i) {
    const auto at = [&](int k) { return power[static_cast<std::size_t>((k + kSteps) % kSteps)]; };
    if (at(i) < at(i - 1) || at(i) <= at(i + 1)) continue;
    PortOffsets o{zero, at(i)};
    o.offset_rad[1] = kTwoPi * i / kSteps;
    for (std::size_t p = 2; p < 2 * ports - 2; ++p) {
      const std::size_t port = p < ports ? p : p - ports + 2;
      const std::vector<double> others = sweep(tags, o.offset_rad, port);
      const auto best = std::max_element(others.begin(), others.end());
      o.offset_rad[port] = kTwoPi * static_cast<double>(best - others.begin()) / kSteps;
      o.power = *best;
    }
    found.push_back(std::move(o));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const PortOffsets& a, const PortOffsets& b) { return a.power > b.power; });
  if (found.size() > count) found.resize(count);
  return found;
}

}  // namespace rfmvo
