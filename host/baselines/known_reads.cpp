#include "baselines/known_reads.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/units.hpp"
#include "estimator/phase_calibration.hpp"
#include "evaluate/alignment.hpp"

namespace rfmvo::baselines {
namespace {

bool usable(const TagRead& read) { return read.seen_count <= 1 && read.frequency_hz != 0; }

struct Hopping {
  PhaseCalibration calibration;
  double mean_hz = 0.0;
};

Hopping learn(const std::vector<Event>& events) {
  Hopping hopping;
  std::map<std::pair<Epc, std::uint8_t>, TagRead> before;
  double sum_hz = 0.0, reads = 0.0;
  for (const Event& event : events) {
    const auto* read = std::get_if<TagRead>(&event);
    if (read == nullptr || !usable(*read)) continue;
    const auto [last, first_read] = before.try_emplace({read->epc, read->port}, *read);
    if (!first_read) hopping.calibration.on_pair(last->second, *read);
    last->second = *read;
    sum_hz += read->frequency_hz;
    reads += 1.0;
  }
  hopping.mean_hz = reads > 0.0 ? sum_hz / reads : 0.0;
  return hopping;
}

// Phase and group of a read: index of its antenna, or one per (antenna, channel).
class Grouping {
 public:
  Grouping(const Hopping& hopping, const Calibration& truth) : hopping_(hopping), truth_(truth) {}

  [[nodiscard]] std::optional<KnownRead> operator()(const TagRead& read, const Rigid3& T_W_C) {
    const auto antenna = std::find_if(truth_.antennas.begin(), truth_.antennas.end(),
                                      [&](const AntennaCalibration& a) { return a.port == read.port; });
    if (antenna == truth_.antennas.end()) return std::nullopt;
    KnownRead known{T_W_C * antenna->p_C_A_m, read.phase.rad(), kSpeedOfLight_m_s / read.frequency_hz,
                    read.frequency_hz, 0};
    const auto excess_m = hopping_.calibration.excess_length_m(read.port);
    if (excess_m) {
      known.phase_rad -= 2.0 * kTwoPi * *excess_m * (read.frequency_hz - hopping_.mean_hz) / kSpeedOfLight_m_s;
      known.wavelength_m = kSpeedOfLight_m_s / hopping_.mean_hz;
    }
    const auto key = std::pair(read.port, excess_m ? 0U : read.frequency_hz);
    known.group = groups_.try_emplace(key, static_cast<int>(groups_.size())).first->second;
    return known;
  }

 private:
  const Hopping& hopping_;
  const Calibration& truth_;
  std::map<std::pair<std::uint8_t, std::uint32_t>, int> groups_;
};

}  // namespace

std::map<Epc, std::vector<KnownRead>> known_reads(const std::vector<Event>& events, const simulate::Truth& truth) {
  const Hopping hopping = learn(events);
  Grouping grouping(hopping, truth.calibration);
  std::map<Epc, std::vector<KnownRead>> by_tag;
  for (const Event& event : events) {
    const auto* read = std::get_if<TagRead>(&event);
    if (read == nullptr || !usable(*read)) continue;
    const auto T_W_C = evaluate::truth_at(truth.trajectory, read->time);
    if (!T_W_C) continue;
    if (const auto known = grouping(*read, *T_W_C)) by_tag[read->epc].push_back(*known);
  }
  return by_tag;
}

}  // namespace rfmvo::baselines
