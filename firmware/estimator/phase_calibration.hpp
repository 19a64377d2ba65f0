// The paper's "phase calibration mechanism" against frequency hopping (section VI), reduced to what
// real readers show: within a band the phase of an antenna port is linear in frequency, so ONE
// excess electrical length per port makes phases of different channels comparable. It is learnt from the
// hops themselves: no calibration step.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <map>
#include <optional>

#include "base/time.hpp"
#include "rf/tag_read.hpp"

namespace rfmvo {

class PhaseCalibration {
 public:
  // Takes part in the learning: two consecutive reads of one tag on one port.
  void on_pair(const TagRead& before, const TagRead& after);

  // The calibrated difference phi(after) - phi(before) in [-2 pi, 2 pi], as two phases in [0, 2 pi) give it;
  // nothing if the channels differ and the port is not known well enough yet.
  [[nodiscard]] std::optional<double> phase_step_rad(const TagRead& before, const TagRead& after) const;

  // Excess electrical length of a port in metres (one way, tag distance included), once known.
  [[nodiscard]] std::optional<double> excess_length_m(std::uint8_t port) const;

 private:
  static constexpr int kLengths = 240;  // candidate lengths
  struct Port {
    std::array<std::complex<double>, kLengths> sums{};  // per candidate: sum of exp(j remaining phase step)
    std::int64_t hops = 0;
    int best = -1;  // candidate of the largest sum; -1: not known yet
  };
  std::map<std::uint8_t, Port> ports_;
};

}  // namespace rfmvo
