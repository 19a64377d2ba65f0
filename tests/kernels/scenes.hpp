// Seeded inputs of the kernels' tests.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "kernels/plane_wave_spectrum.hpp"
#include "kernels/spectrum_reference.hpp"
#include "kernels/spherical_wave_spectrum.hpp"

namespace rfmvo::testing {

inline constexpr double kWavelength_m = 0.325;

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * unit_(generator_); }
  float uniform_f(double low, double high) { return static_cast<float>(uniform(low, high)); }
  int integer(int low, int high) { return low + static_cast<int>(uniform(0.0, 1.0) * (high - low + 1)); }
  double normal() { return normal_(generator_); }

 private:
  std::mt19937 generator_;
  std::uniform_real_distribution<double> unit_{0.0, std::nextafter(1.0, 0.0)};
  std::normal_distribution<double> normal_;
};

inline std::uint16_t code_of_turns(double turns) {
  return static_cast<std::uint16_t>(static_cast<std::int64_t>(std::llround(turns * 65536.0)));
}

// Antennas along a path of 1.6 m, phases at random.
inline std::vector<SphericalWaveRead> random_reads(Random& random, int count, int groups) {
  std::vector<SphericalWaveRead> reads;
  for (int i = 0; i < count; ++i)
    reads.push_back({{random.uniform_f(-0.8, 0.8), random.uniform_f(-0.1, 0.1), random.uniform_f(0.0, 0.6)},
                     random.uniform_f(6.10, 6.20),
                     static_cast<std::uint16_t>(random.integer(0, 65535)),
                     random.integer(1, groups)});
  return reads;
}

inline CellBlock random_block(Random& random, double reach_m) {
  const auto place = [&] { return random.uniform_f(-reach_m, reach_m); };
  const auto step = [&] { return random.uniform_f(0.01, 0.2); };
  return {{place(), place(), place()}, {step(), step(), step()}};
}

// How the cart moves while an array is read.
enum class Motion { kStraight, kTurning, kUneven };

// Steps of 1 to 4 cm at gamma = 1, from a tag far away in a random direction of the grid's hemisphere, with noise on
// the reads, so correlated noise on their differences.
inline std::vector<PlaneWaveStep> plane_wave_steps(Random& random, int count, Motion motion, double noise_rad) {
  const double alpha = random.uniform(0.0, reference::kTwoPi / 2), beta = random.uniform(0.0, reference::kTwoPi / 2);
  const reference::Point u{std::cos(alpha) * std::cos(beta), std::sin(alpha) * std::cos(beta), std::sin(beta)};
  std::vector<PlaneWaveStep> steps;
  double yaw = random.uniform(0.0, reference::kTwoPi), before = noise_rad * random.normal();
  for (int i = 0; i < count; ++i) {
    const double turns = 2.0 / kWavelength_m * random.uniform(0.01, 0.04);
    if (motion != Motion::kStraight) yaw += (motion == Motion::kTurning ? 0.02 : 0.1) * random.normal();
    const double up = motion == Motion::kUneven ? 0.3 * turns * random.normal() : 0.0;
    const reference::Point camera{turns * std::cos(yaw), turns * std::sin(yaw), up};
    PlaneWaveStep step;
    double phase_turns = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      step.camera_turns[axis] = static_cast<float>(camera[axis]);
      phase_turns -= camera[axis] * u[axis];
    }
    const double after = noise_rad * random.normal();
    step.phase_step_q16 = code_of_turns(phase_turns + (after - before) / reference::kTwoPi);
    before = after;
    steps.push_back(step);
  }
  return steps;
}

// Poison on both sides of what is written.
template <class T>
struct Guarded {
  alignas(64) std::array<unsigned char, 64> before;
  T value;
  std::array<unsigned char, 64> after;

  Guarded() : before(poison()), value{}, after(poison()) {}
  [[nodiscard]] bool intact() const { return before == poison() && after == poison(); }

 private:
  static std::array<unsigned char, 64> poison() {
    std::array<unsigned char, 64> p;
    p.fill(0xA5);
    return p;
  }
};

}  // namespace rfmvo::testing
