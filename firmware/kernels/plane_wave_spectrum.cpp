#include "kernels/plane_wave_spectrum.hpp"

#include <algorithm>
#include <cmath>

#include "base/assert.hpp"

namespace rfmvo {
namespace {

constexpr float kFirst_q24 = 16777216.0F;  // 2^24
constexpr float kStep_q27 = 134217728.0F;  // 2^27
// What an int32 holds of either.
constexpr double kMaxFirst_turns = 127.0, kMaxStep_turns = 15.0;

std::uint32_t angle_q32(const std::array<float, 3>& slope, float x, float y, float z, int shift) {
  const float along = (slope[0] * x + slope[1] * y) + slope[2] * z;
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lrint(along))) << shift;
}

// Sum of the components' sizes: no scalar product with a unit vector has a larger term or sum on its way.
double length(const std::array<float, 3>& v) {
  return std::abs(double{v[0]}) + std::abs(double{v[1]}) + std::abs(double{v[2]});
}

}  // namespace

PlaneWaveSpectrum::PlaneWaveSpectrum(std::span<const PlaneWaveStep> steps, const ScaleSteps& scales)
    : steps_(static_cast<int>(steps.size())) {
  RFMVO_ASSERT(!steps.empty() && static_cast<std::int64_t>(steps.size()) <= kMaxTerms_q15);
  for (std::size_t i = 0; i < steps.size(); i += 2) {
    Pair pair;
    for (std::size_t half = 0; half < 2; ++half) {
      const PlaneWaveStep& s = steps[std::min(i + half, steps.size() - 1)];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float first = s.lever_turns[axis] + scales.first * s.camera_turns[axis];
        pair.first[half][axis] = kFirst_q24 * first;
        pair.step[half][axis] = kStep_q27 * (scales.step * s.camera_turns[axis]);
      }
      pair.phase_q32[half] = static_cast<std::int32_t>(std::uint32_t{s.phase_step_q16} << 16);
    }
    pairs_.push_back(pair);
    for (std::size_t half = 0; half < 2; ++half) {
      first_turns_ = std::max(first_turns_, length(pair.first[half]) / double{kFirst_q24});
      step_turns_ = std::max(step_turns_, length(pair.step[half]) / double{kStep_q27});
    }
  }
  RFMVO_ASSERT(first_turns_ < kMaxFirst_turns && step_turns_ < kMaxStep_turns);
}

void PlaneWaveSpectrum::evaluate_scalar(const Directions& directions, int begin, int end,
                                        std::span<std::int32_t> sums) const {
  RFMVO_ASSERT(0 <= begin && begin <= end && sums.size() == directions.size() * static_cast<std::size_t>(end - begin));
  std::fill(sums.begin(), sums.end(), 0);
  for (std::size_t d = 0; d < directions.size(); ++d) {
    const float x = directions.x[d], y = directions.y[d], z = directions.z[d];
    for (int i = 0; i < steps_; ++i) {
      const Pair& pair = pairs_[static_cast<std::size_t>(i / 2)];
      const auto half = static_cast<std::size_t>(i % 2);
      const std::uint32_t first =
          static_cast<std::uint32_t>(pair.phase_q32[half]) + angle_q32(pair.first[half], x, y, z, 8);
      const std::uint32_t step = angle_q32(pair.step[half], x, y, z, 5);
      for (int n = begin; n < end; ++n) {
        const std::uint32_t angle = first + static_cast<std::uint32_t>(n) * step;
        sums[static_cast<std::size_t>(n - begin) * directions.size() + d] +=
            cosine_q15(static_cast<std::uint16_t>(angle >> 16));
      }
    }
  }
}

}  // namespace rfmvo
