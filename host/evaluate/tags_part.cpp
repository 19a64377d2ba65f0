#include <Eigen/Cholesky>
#include <algorithm>
#include <set>

#include "evaluate/alignment.hpp"
#include "evaluate/parts.hpp"

namespace rfmvo::evaluate {
namespace {

std::optional<double> normalised_square(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return std::nullopt;
  const Eigen::LLT<Eigen::Matrix3d> cholesky(covariance);
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  return error.dot(cholesky.solve(error));
}

const SegmentEvaluation* find(const TrajectoryEvaluation& trajectory, std::uint32_t segment) {
  const auto found = std::find_if(trajectory.segments.begin(), trajectory.segments.end(),
                                  [&](const SegmentEvaluation& s) { return s.segment == segment; });
  return found == trajectory.segments.end() ? nullptr : &*found;
}

void compare_in_world(const TagEstimate& estimate, const Rigid3& T_truth_W, TagEvaluation& tag) {
  const Eigen::Vector3d error = T_truth_W * estimate.p_W_X_m - tag.true_p_W_X_m;
  const Eigen::Matrix3d R = T_truth_W.R.toRotationMatrix();
  tag.error_m = error.norm();
  tag.nees_world = normalised_square(error, R * estimate.covariance_m2 * R.transpose());
  tag.best_hypothesis_error_m = tag.error_m;
  for (const TagHypothesis& hypothesis : estimate.hypotheses) {
    if (!hypothesis.p_W_X_m.allFinite()) continue;
    const double other = (T_truth_W * hypothesis.p_W_X_m - tag.true_p_W_X_m).norm();
    tag.best_hypothesis_error_m = std::min(*tag.best_hypothesis_error_m, other);
  }
}

// A position of exactly zero, the camera's own centre, means that the estimator gave none.
void compare_in_camera(const TagEstimate& estimate, const simulate::Truth& truth, TagEvaluation& tag) {
  if (!estimate.p_C_X_m.allFinite() || estimate.p_C_X_m.isZero(0.0)) return;
  const auto T_W_C = truth_at(truth.trajectory, estimate.closest_approach);
  if (!T_W_C) return;
  const Eigen::Vector3d error = estimate.p_C_X_m - T_W_C->inverse() * tag.true_p_W_X_m;
  tag.camera_relative_error_m = error.norm();
  tag.nees_camera = normalised_square(error, estimate.covariance_C_m2);
}

TagEvaluation evaluate_tag(const simulate::TrueTag& true_tag, const LastEstimates& last, const simulate::Truth& truth,
                           const TrajectoryEvaluation& trajectory) {
  TagEvaluation tag;
  tag.epc = true_tag.epc;
  tag.true_p_W_X_m = true_tag.p_W_X_m;
  const auto found = last.tags.find(true_tag.epc);
  if (found == last.tags.end()) return tag;
  tag.estimate = found->second;
  tag.located = is_located(found->second);
  if (!tag.located) return tag;
  if (const auto* segment = find(trajectory, found->second.segment)) {
    compare_in_world(found->second, segment->T_truth_W, tag);
  }
  compare_in_camera(found->second, truth, tag);
  return tag;
}

struct Coverage {
  int tags = 0, inside = 0;
  std::vector<double> nees;

  void add(const std::optional<double>& value) {
    ++tags;
    if (!value) return;
    nees.push_back(*value);
    if (*value <= kChi2_95_3dof) ++inside;
  }
  [[nodiscard]] std::optional<double> share() const {
    return tags == 0 ? std::nullopt : std::optional(static_cast<double>(inside) / tags);
  }
  [[nodiscard]] std::optional<double> mean() const {
    const auto summary = summarise(nees);
    return summary ? std::optional(summary->mean) : std::nullopt;
  }
};

}  // namespace

TagsEvaluation evaluate_tags(const LastEstimates& last, const simulate::Truth& truth,
                             const TrajectoryEvaluation& trajectory) {
  TagsEvaluation result;
  std::vector<double> errors, camera_errors;
  Coverage camera, world;
  std::set<Epc> known;
  for (const simulate::TrueTag& true_tag : truth.tags) {
    known.insert(true_tag.epc);
    const TagEvaluation tag = evaluate_tag(true_tag, last, truth, trajectory);
    if (tag.located) ++result.located;
    if (tag.error_m) {
      errors.push_back(*tag.error_m);
      world.add(tag.nees_world);
    }
    if (tag.camera_relative_error_m) {
      camera_errors.push_back(*tag.camera_relative_error_m);
      camera.add(tag.nees_camera);
    }
    result.tags.push_back(tag);
  }
  for (const auto& [epc, estimate] : last.tags) {
    if (!known.contains(epc)) result.unknown.push_back(epc);
  }
  result.total = static_cast<int>(truth.tags.size());
  result.error_m = summarise(errors);
  result.camera_relative_m = summarise(camera_errors);
  result.coverage95 = camera.share();
  result.coverage95_world = world.share();
  result.nees_mean = camera.mean();
  result.nees_world_mean = world.mean();
  return result;
}

}  // namespace rfmvo::evaluate
