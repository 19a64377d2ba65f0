// What the holographic methods share: a likelihood for every cell of a surveillance region, from phases that a tag
// gave to antennas at KNOWN positions. Float: a residual of up to 20 turns is right to 2e-6 of a turn.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace rfmvo::baselines {

// One read of one tag. Phases are comparable within a group; groups differ by an unknown constant.
struct KnownRead {
  Eigen::Vector3d p_W_A_m;  // the antenna's true place
  double phase_rad = 0.0;   // grows with distance: 4 pi d / wavelength + a constant of the group
  double wavelength_m = 0.0;
  std::uint32_t frequency_hz = 0;  // of the channel it was read on
  int group = 0;                   // 0, 1, ...: antenna (known_reads.hpp)
};

// Cuboids around a centre. RF-MVO gives both baselines 60 x 60 x 25 cells of 1 cm around the true tag; here z is up.
struct Region {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  std::array<int, 3> cells{60, 60, 25};
  double cell_m = 0.01;

  [[nodiscard]] Eigen::Vector3d cell_centre(int i, int j, int k) const;
};

struct HologramPeak {
  Eigen::Vector3d p_W_X_m = Eigen::Vector3d::Zero();  // centre of the cell
  double likelihood = 0.0;
  bool at_edge = false;  // outermost layer: the true maximum may lie outside
};

// The first of the likeliest cells.
[[nodiscard]] HologramPeak likeliest_cell(const Region& region,
                                          const std::function<double(const Eigen::Vector3d&)>& likelihood);

// Measured minus predicted phase of reads, in turns, without the unknown constant.
class Residuals {
 public:
  explicit Residuals(std::span<const KnownRead> reads);

  // Valid until the next call.
  [[nodiscard]] const Eigen::ArrayXf& at(const Eigen::Vector3d& p_W_X_m);

 private:
  Eigen::Vector3d origin_;
  Eigen::ArrayXf x_, y_, z_, phase_, turns_per_m_, turns_;
};

// Reads by group, in order.
[[nodiscard]] std::vector<std::vector<KnownRead>> by_group(std::span<const KnownRead> reads);

// A complex function of an angle, tabulated: 4096 steps of 1.5 mrad, what a reader resolves.
class TurnTable {
 public:
  // `function` of the angle in radians, [-pi, pi).
  explicit TurnTable(const std::function<std::complex<double>(double)>& function);

  [[nodiscard]] std::complex<float> operator()(float turns) const {
    return values_[static_cast<std::uint32_t>(static_cast<std::int32_t>(turns * kSteps + kBias)) % kSteps];
  }

 private:
  static constexpr std::uint32_t kSteps = 4096;
  static constexpr float kBias = 0.5F + 1000.0F * kSteps;  // positive: truncation rounds to the nearest
  std::vector<std::complex<float>> values_;
};

}  // namespace rfmvo::baselines
