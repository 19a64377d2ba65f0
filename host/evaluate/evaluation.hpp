// How far a result is from the truth. Every number is defined here.
#pragma once

#include <optional>
#include <vector>

#include "base/result.hpp"
#include "estimator/estimate.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::evaluate {

// 95 % of the chi-square distribution with 3 degrees of freedom.
inline constexpr double kChi2_95_3dof = 7.814727903251179;
// Shorter true steps between two odometry poses are left out of Eq. (31): with 1 mm of position noise
// on either pose the ratio of such a step is noise, not scale.
inline constexpr double kMinStep_m = 0.005;
// Below this spread of the true path about a straight line its positions do not fix the roll (a bend of
// one per cent of the path would be read as roll): tags are then aligned with the camera's orientations.
inline constexpr double kStraightSpread_m = 0.2;
inline constexpr double kOrientationLever_m = 1.0;  // a usual distance of a tag from the path

struct Summary {
  double mean = 0.0;
  double median = 0.0;
  double rmse = 0.0;
  double max = 0.0;
};
// Nothing for no values.
[[nodiscard]] std::optional<Summary> summarise(std::vector<double> values);

struct TagEvaluation {
  Epc epc;
  Eigen::Vector3d true_p_W_X_m = Eigen::Vector3d::Zero();  // in the truth's world
  std::optional<TagEstimate> estimate;                     // the last one; nothing: the tag was never reported
  bool located = false;                                    // is_located(); only then the fields below
  // |T p_estimated - p_true| after the SE(3) alignment of the segment's path (scale is not aligned).
  std::optional<double> error_m;
  // The smallest such error among the hypotheses of the tag.
  std::optional<double> best_hypothesis_error_m;
  // |p_C_X - R_W_C^T (p_W_X - p_W_C)| at the closest approach: Eq. (30), in the camera's frame.
  std::optional<double> camera_relative_error_m;
  // Normalised squared error e^T C^-1 e; nothing if C is not positive definite.
  std::optional<double> nees_camera;
  std::optional<double> nees_world;
};

struct TagsEvaluation {
  std::vector<TagEvaluation> tags;  // in the truth's order
  std::vector<Epc> unknown;         // reported, but not in the truth; not counted anywhere
  int total = 0;                    // tags in the truth
  int located = 0;
  std::optional<Summary> error_m, camera_relative_m;
  // Share of the located tags inside the 95 % ellipsoid of their covariance. A covariance that is not
  // positive definite claims certainty: it counts as outside.
  std::optional<double> coverage95;                  // p_C_X, covariance_C
  std::optional<double> coverage95_world;            // p_W_X, covariance, after alignment
  std::optional<double> nees_mean, nees_world_mean;  // 3 if honest
};

struct SegmentEvaluation {
  std::uint32_t segment = 0;
  int poses = 0;     // that have a truth
  Rigid3 T_truth_W;  // alignment used for tags: p_truth = T_truth_W * p_W
  bool aligned_with_orientations = false;
  double ate_se3_m = 0.0;   // RMS position error after SE(3) alignment on positions, as `evo_ape -a`
  double ate_sim3_m = 0.0;  // the same after Sim(3), as `evo_ape -as`
  double sim3_scale = 1.0;  // true metre per estimated metre, as evo finds it with -s
  double path_m = 0.0;      // true path between the associated poses
};

// Over several segments (each aligned by itself): ATE is the RMS over all poses, errors of scale are
// means weighted with the true path.
struct TrajectoryEvaluation {
  std::vector<SegmentEvaluation> segments;
  std::optional<double> ate_se3_m, ate_sim3_m;
  double path_m = 0.0;  // the whole true path
};

struct ScaleEvaluation {
  std::optional<double> relative_error;  // |sim3_scale - 1|
  // Eq. (31): mean over consecutive odometry poses of |gamma - |d truth| / |d V||, gamma the last scale
  // of the segment; and the same as a fraction of the ratio.
  std::optional<double> eq31, eq31_relative;
  int eq31_steps = 0;
  // Of the segment with the longest true path:
  std::optional<ScaleEstimate> estimate;
  std::optional<double> true_m_per_unit;  // of the odometry's path, by Sim(3) on the truth
};

struct Evaluation {
  TagsEvaluation tags;
  TrajectoryEvaluation trajectory;
  ScaleEvaluation scale;
};

// Errors: the truth has no tags and no path; a result whose path and the truth have no time in common.
// A result without path or tags is no error: what it does not say stays empty.
[[nodiscard]] Result<Evaluation> evaluate(const std::vector<Estimate>& estimates, const simulate::Truth& truth);

}  // namespace rfmvo::evaluate
