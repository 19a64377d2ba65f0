// The last word of a result log: estimates are revisions, each replaces the earlier ones.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "estimator/estimate.hpp"

namespace rfmvo::evaluate {

struct LastEstimates {
  std::map<std::uint32_t, Trajectory> trajectories;  // by segment; those without poses are left out
  std::map<Epc, TagEstimate> tags;
  std::map<std::uint32_t, ScaleEstimate> scales;  // by segment
  std::vector<CameraPose> camera_poses;           // visual odometry, all of them, in order
  std::optional<Health> health;
};

[[nodiscard]] LastEstimates last_of(const std::vector<Estimate>& estimates);

// A tag is located if its estimate claims a metric position: finite, and a status other than
// kTooFewReads and kNoScale. Circle, mirror and weak geometry count: their error is on record.
[[nodiscard]] bool is_located(const TagEstimate& tag);

// 1 sigma per axis; 0 where the variance is not a positive number.
[[nodiscard]] Eigen::Vector3d sigma_of(const Eigen::Matrix3d& covariance);

// "CONVERGED" and so on, as in tag_estimate_t.lcm.
[[nodiscard]] const char* label_of(TagStatus status);
[[nodiscard]] const char* label_of(VoStatus status);

}  // namespace rfmvo::evaluate
