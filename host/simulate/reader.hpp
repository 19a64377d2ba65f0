// The reader's own share: channel hopping, cables, the phase it reports and how it rounds it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulate/inventory.hpp"

namespace rfmvo::simulate {

// Ten channels, 500 kHz apart, from 920.625 MHz: as the AdaRF recordings, within the 920..926 MHz band
// of the paper's reader. A hop every 0.2 s in a pseudo-random order that repeats.
class ChannelPlan {
 public:
  static constexpr std::size_t kChannels = 10;
  explicit ChannelPlan(std::uint64_t seed);
  [[nodiscard]] double frequency_hz(double t_s) const;
  [[nodiscard]] const std::array<double, kChannels>& hops_hz() const { return hops_hz_; }  // in hop order

 private:
  std::array<double, kChannels> hops_hz_{};
};

// Unknown to the estimator. Phase of a read = space + tag + port + 4 pi f L / c.
struct ReaderHardware {
  std::vector<double> tag_offset_rad;
  std::vector<double> port_offset_rad;
  std::vector<double> port_length_m;  // electrical length: measured 0.199 rad per 0.5 MHz = 9.5 m
};
[[nodiscard]] ReaderHardware draw_hardware(std::size_t tags, std::size_t ports, std::uint64_t seed);

// What goes wrong with a phase; switched off for tests of the parts, raised for stress.
struct ReaderNoise {
  bool white = true;
  bool flips = true;
  double flip_share = Options{}.flip_share;        // of the reads
  double outlier_share = Options{}.outlier_share;  // of the reads: a phase drawn from the whole turn
};

// Reports in time order; times are on the scene's clock (epoch added by the caller's `start`).
[[nodiscard]] std::vector<TagRead> report(const Scene& scene, const std::vector<Singulation>& singulations,
                                          const RadioLink& link, const ReaderHardware& hardware, std::uint64_t seed,
                                          DeviceTime epoch, ReaderNoise noise = {});

}  // namespace rfmvo::simulate
