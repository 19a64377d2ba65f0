#include "simulate/reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/units.hpp"
#include "simulate/random.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kFirstChannel_hz = 920.625e6, kChannelStep_hz = 0.5e6;
constexpr double kHopDwell_s = 0.2;
constexpr double kPortLengthMin_m = 5.0, kPortLengthMax_m = 10.0;
constexpr double kFlipStay = 0.8;            // pi flips of the reader come in bursts: mean 5 reads of one (tag, port)
constexpr std::int64_t kPhaseCounts = 4096;  // Impinj: 12 bits a turn,
constexpr std::int64_t kPhaseStep = 2;       // of which only even counts occur
constexpr std::int64_t kTurnPerCount = 65536 / kPhaseCounts;
constexpr Duration kReaderClockOffset{-800'000'000};  // the reader's clock against the device's

// 12 bits, even: what an R420 can say. The simulator's own conversion, not the estimator's.
std::uint16_t quantise(double phase_rad) {
  const double turns = phase_rad / kTwoPi;
  const double fraction = turns - std::floor(turns);
  const auto count = std::llround(fraction * (kPhaseCounts / kPhaseStep)) % (kPhaseCounts / kPhaseStep) * kPhaseStep;
  return static_cast<std::uint16_t>(count * kTurnPerCount);
}

}  // namespace

ChannelPlan::ChannelPlan(std::uint64_t seed) {
  for (std::size_t k = 0; k < kChannels; ++k) hops_hz_[k] = kFirstChannel_hz + static_cast<double>(k) * kChannelStep_hz;
  Random random(seed, "channel hops");
  for (std::size_t k = kChannels - 1; k > 0; --k) std::swap(hops_hz_[k], hops_hz_[random.below(k + 1)]);
}

double ChannelPlan::frequency_hz(double t_s) const {
  const auto hop = static_cast<std::int64_t>(std::floor(t_s / kHopDwell_s));
  return hops_hz_[static_cast<std::size_t>(hop) % kChannels];
}

ReaderHardware draw_hardware(std::size_t tags, std::size_t ports, std::uint64_t seed) {
  ReaderHardware hardware;
  Random tag_random(seed, "tag offsets");
  for (std::size_t n = 0; n < tags; ++n) hardware.tag_offset_rad.push_back(tag_random.uniform(0.0, kTwoPi));
  Random port_random(seed, "ports");
  for (std::size_t n = 0; n < ports; ++n) {
    hardware.port_offset_rad.push_back(port_random.uniform(0.0, kTwoPi));
    hardware.port_length_m.push_back(port_random.uniform(kPortLengthMin_m, kPortLengthMax_m));
  }
  return hardware;
}

std::vector<TagRead> report(const Scene& scene, const std::vector<Singulation>& singulations, const RadioLink& link,
                            const ReaderHardware& hardware, std::uint64_t seed, DeviceTime epoch, ReaderNoise noise) {
  const ChannelPlan channels(seed);
  const std::size_t ports = scene.calibration.antennas.size();
  Random white(seed, "white phase");
  Random flips(seed, "pi flips");
  Random strength(seed, "rssi");
  Random outliers(seed, "outliers");
  const double flip_enter = noise.flip_share / (1.0 - noise.flip_share) * (1.0 - kFlipStay);
  std::vector<std::optional<bool>> flipped(scene.tags.size() * ports);
  std::vector<TagRead> reads;
  for (const Singulation& s : singulations) {
    const double f_hz = channels.frequency_hz(s.t_s);
    const LinkState state = link(s.t_s, s.antenna, s.tag, f_hz);
    std::optional<bool>& flip = flipped[s.tag * ports + s.antenna];
    flip = flips.uniform() < (!flip ? noise.flip_share : *flip ? kFlipStay : flip_enter);
    double phase_rad = state.phase_rad + hardware.tag_offset_rad[s.tag] + hardware.port_offset_rad[s.antenna] +
                       2.0 * kTwoPi * f_hz * hardware.port_length_m[s.antenna] / kSpeedOfLight_m_s;
    const double white_rad = state.white_sigma_rad * white.normal();
    if (noise.white) phase_rad += white_rad;
    if (noise.flips && *flip) phase_rad += kPi;
    const double draw = outliers.uniform(), anything_rad = outliers.uniform(0.0, kTwoPi);
    if (draw < noise.outlier_share) phase_rad = anything_rad;

    TagRead read;
    const Duration since_epoch{std::llround(s.t_s * 1e6) * 1000};  // LLRP stamps are microseconds
    read.time = epoch + since_epoch;
    read.reader_time = ReaderTime{read.time.ns} + kReaderClockOffset;
    read.epc = scene.tags[s.tag].epc;
    read.port = scene.calibration.antennas[s.antenna].port;
    read.phase.turn_q16 = quantise(phase_rad);
    read.frequency_hz = static_cast<std::uint32_t>(std::llround(f_hz));
    // Impinj reports peak RSSI in steps of 0.5 dB; 0.3 dB of scatter is what a still tag shows.
    read.rssi_cdbm = static_cast<std::int16_t>(std::lround((state.rssi_dbm + 0.3 * strength.normal()) * 2.0) * 50);
    read.seen_count = 1;
    reads.push_back(read);
  }
  return reads;
}

}  // namespace rfmvo::simulate
