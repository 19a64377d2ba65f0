// Alignment of an estimated path to the true one, and the truth at a given time.
#pragma once

#include <optional>
#include <vector>

#include "geometry/rigid.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::evaluate {

// One estimated camera pose and the truth at the same time.
struct PosePair {
  Rigid3 estimated;
  Rigid3 truth;
};

// p_truth = scale * T.R * p_estimated + T.t
struct Similarity {
  double scale = 1.0;
  Rigid3 T;

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return T.t + scale * (T.R * p); }
};

struct AlignmentOptions {
  bool with_scale = false;
  // 0: positions only (Umeyama 1991, as evo does). L^2: orientations too, as if every camera carried
  // points at +-L on its axes; keeps the roll about a straight path determined. Not with_scale.
  double orientation_weight_m2 = 0.0;
};

// Least squares over all pairs; nothing if there are fewer than 3 pairs or the estimate does not move.
// On a straight path without orientation weight the roll about the path is arbitrary; the residuals are not.
[[nodiscard]] std::optional<Similarity> align(const std::vector<PosePair>& pairs, const AlignmentOptions& options);

// Root mean square of the position residuals after `alignment`, metres.
[[nodiscard]] double position_rmse_m(const std::vector<PosePair>& pairs, const Similarity& alignment);

// RMS distance of the true positions from the straight line through them, second axis (the larger one).
[[nodiscard]] double spread_off_line_m(const std::vector<PosePair>& pairs);

// Truth at `time` by interpolation; nothing outside the truth (but for kTimeSlack) or inside a gap of
// it longer than kMaxTruthGap.
inline constexpr Duration kTimeSlack{1'000'000};      // 1 ms: results carry whole microseconds
inline constexpr Duration kMaxTruthGap{500'000'000};  // 0.5 s: a cart turns 10 degrees within it
[[nodiscard]] std::optional<Rigid3> truth_at(const std::vector<simulate::TruePose>& trajectory, DeviceTime time);

}  // namespace rfmvo::evaluate
