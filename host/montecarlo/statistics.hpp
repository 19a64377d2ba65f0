// What many seeds say together. Every number is defined here; errors are of the tag relative to the camera
// at the closest approach (evaluate/evaluation.hpp), over all located tags of all seeds, unless said.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "montecarlo/experiment.hpp"

namespace rfmvo::montecarlo {

// Chance to lie outside an honest ellipsoid: one in a million. Chi-square with 3 degrees of freedom.
inline constexpr double kChi2_1em6_3dof = 30.66484970621361;
// An error that a published sigma does not excuse: above three of it, and large enough to matter.
inline constexpr double kExcusedSigmas = 3.0;
inline constexpr double kMatters_m = 0.25;
// A tag counts as located well below this published sigma (root of the trace).
inline constexpr double kLocatedSigma_m = 0.25;

// A tag that says CONVERGED and is not where it says: its truth lies outside the published ellipsoid at
// the chance of 1e-6, or its error is above 3 published sigmas and above 25 cm, or its covariance is not
// positive definite.
[[nodiscard]] bool is_unflagged_wrong(const evaluate::TagEvaluation& tag);

struct Statistics {
  std::size_t seeds = 0;
  std::size_t tags = 0;                         // over all seeds
  std::size_t located = 0;                      // status other than TOO_FEW_READS, NO_SCALE
  std::map<std::string, std::size_t> statuses;  // NOT_SEEN: never reported
  std::optional<evaluate::Summary> error_m;
  // Cramer-Rao bound (bound/bound.hpp) of the located tags that have one: root of their mean trace; and the
  // root mean square error of these tags over it.
  std::optional<double> bound_rmse_m, bound_median_m, ratio;
  std::size_t unbounded = 0;  // tags without a bound, located or not
  // The same with the lobes that phases alone leave (bound/lobes.hpp), over the same tags; and the share of them that
  // an observer who knows all else would put at a wrong place.
  std::optional<double> lobe_bound_rmse_m, lobe_ratio, lobe_wrong_share;
  std::optional<double> known_path_rmse_m, known_path_bound_rmse_m;
  std::optional<double> coverage95, nees_mean, nees_median;
  // Of the recovered path against the true one: RMS over seeds of |Sim(3) scale - 1|.
  // And its bound, RMS over the same seeds.
  std::optional<double> scale_rms_relative, scale_bound_rms_relative;
  std::size_t scales = 0;  // seeds that have one
  std::size_t unflagged_wrong = 0;
  std::size_t unflagged_wrong_that_matters = 0;  // of these, with an error above 25 cm
  // Tags that are not CONVERGED; nothing where the scene is degenerate on purpose.
  std::optional<std::size_t> false_alarms;
  std::size_t located_sigma25 = 0;  // located tags with a published sigma (root of the trace) below 25 cm
  double per_read_p99_s = 0.0;      // wall time of Pipeline::on for a TagRead
  double run_s = 0.0;               // mean wall time of a seed in the estimator
  double realtime_factor = 0.0;     // recorded time over CPU time
};

[[nodiscard]] Statistics statistics_of(const std::vector<SeedRun>& runs, const Options& options);

}  // namespace rfmvo::montecarlo
