// The spatial power spectrum of Eq. (6) in fixed point, over directions u and scales gamma:
//   sum(u, n) = sum over steps i of cos(Delta phi_i + 2 pi (lever_i + gamma_n camera_i)' u),
//   gamma_n = first + n * step;   P = sum / (32768 steps).
//
// Format:     Delta phi a binary angle (binary_angle.hpp), cosines Q15, sums int32.
// Angle:      uint32, 2^32 = one turn: phase + first + n * step, which wraps by itself; its upper 16 bits
//             are the binary angle. `first` is a float scalar product in 2^-24 turns, `step` in 2^-27 turns, each
//             ((x + y) + z) without contraction and rounded to the nearest integer (half to even): the same bits on
//             every target.
// Range:      asserted: the sizes of the components of lever + first camera sum to less than 127 turns, those of
//             step camera to less than 15; 1..kMaxTerms_q15 steps.
// Saturation: none after the cosine: an int32 holds kMaxTerms_q15 of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/binary_angle.hpp"

namespace rfmvo {

struct PlaneWaveStep {
  std::uint16_t phase_step_q16 = 0;     // Delta phi
  std::array<float, 3> lever_turns{};   // 2 / lambda * step of the lever arm; zero in Eq. (1)
  std::array<float, 3> camera_turns{};  // 2 / lambda * Delta X_C, per unit of gamma
};

struct ScaleSteps {
  float first = 1.0F, step = 0.0F;
  int count = 1;
  [[nodiscard]] double at(int n) const { return double{first} + n * double{step}; }
};

// Unit vectors of Eq. (15), component by component.
struct Directions {
  std::span<const float> x, y, z;
  [[nodiscard]] std::size_t size() const { return x.size(); }
};

// |Q15 cosine of a term - exact| at scale number n. A truncated angle is within half a code of the middle that its
// code stands for, which kCosineMaxAbsError counts already. `first` and `step`, of at most so many turns, are
// rounded to 2^-25 and 2^-28 turns after 6 float roundings (2^-24: coefficient twice, product, two sums, spare).
[[nodiscard]] constexpr double plane_wave_max_abs_error(double first_turns, double step_turns, int n) {
  constexpr double kFloat = 6.0 / (1 << 24), kRadPerTurn = 6.2832;
  const double first = kFloat * first_turns + 1.0 / (1 << 25);
  const double step = kFloat * step_turns + 1.0 / (1 << 28);
  return kCosineMaxAbsError + kRadPerTurn * (first + n * step);
}

class PlaneWaveSpectrum {
 public:
  // Two steps per 32-bit lane.
  struct Pair {
    std::array<std::array<float, 3>, 2> first;  // 2^24 (lever + gamma_0 camera)
    std::array<std::array<float, 3>, 2> step;   // 2^27 Delta gamma camera
    std::array<std::int32_t, 2> phase_q32;      // 2^32 = one turn
  };

  PlaneWaveSpectrum(std::span<const PlaneWaveStep> steps, const ScaleSteps& scales);

  // sums[(n - begin) * directions.size() + d], begin <= n < end. On the best vector unit of this machine.
  void evaluate(const Directions& directions, int begin, int end, std::span<std::int32_t> sums) const;
  // The definition: the same bits.
  void evaluate_scalar(const Directions& directions, int begin, int end, std::span<std::int32_t> sums) const;

  [[nodiscard]] std::span<const Pair> pairs() const { return pairs_; }
  [[nodiscard]] bool odd() const { return steps_ % 2 != 0; }  // the last pair's second step does not count
  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] double power(std::int32_t sum) const { return sum / (kOne_q15 * steps_); }  // P
  // Of P at scale number n: plane_wave_max_abs_error of the longest steps.
  [[nodiscard]] double max_abs_error(int n) const { return plane_wave_max_abs_error(first_turns_, step_turns_, n); }

 private:
  std::vector<Pair> pairs_;
  int steps_ = 0;
  double first_turns_ = 0.0, step_turns_ = 0.0;  // the longest
};

}  // namespace rfmvo
