#include "estimator/tag_map.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace rfmvo {
namespace {

bool sure(const TagEstimate& e) {
  return e.status == TagStatus::kConverged || e.status == TagStatus::kStale || e.status == TagStatus::kMoved;
}

}  // namespace

bool says_more(const TagEstimate& a, const TagEstimate& b) {
  const auto rank = [](const TagEstimate& e) {
    return e.status == TagStatus::kTooFewReads ? 0 : e.status == TagStatus::kNoScale ? 1 : 2;
  };
  if (rank(a) != rank(b)) return rank(a) > rank(b);
  return a.covariance_C_m2.trace() < b.covariance_C_m2.trace();
}

bool contradict(const TagEstimate& a, const TagEstimate& b) {
  constexpr double kFar_m = 0.17, kChi2_3dof = 21.1;  // P(chi2 > 21.1) = 1e-4
  if (!sure(a) || !sure(b)) return false;
  const Eigen::Vector3d d = a.p_W_X_m - b.p_W_X_m;
  const Eigen::Matrix3d covariance = a.covariance_m2 + b.covariance_m2;
  return d.norm() > kFar_m && d.dot(covariance.ldlt().solve(d)) > kChi2_3dof;
}

void TagMap::keep(const TagEstimate& estimate, DeviceTime last_read) {
  const auto found = kept_.find(estimate.epc);
  if (found == kept_.end()) {
    kept_.emplace(estimate.epc, Kept{estimate, last_read});
    return;
  }
  Kept& kept = found->second;
  TagEstimate better = best(estimate.epc, &estimate, estimate.time);
  kept = {std::move(better), std::max(kept.last_read, last_read)};
}

TagEstimate TagMap::best(const Epc& epc, const TagEstimate* open, DeviceTime now) const {
  const auto found = kept_.find(epc);
  if (found == kept_.end()) return *open;
  TagEstimate e = found->second.estimate;
  if (open != nullptr) {
    const bool moved = contradict(e, *open);
    if (moved || says_more(*open, e)) e = *open;
    if (moved) e.status = TagStatus::kMoved;
    // Held where it was found after the move: the news is over.
    else if (e.status == TagStatus::kMoved && sure(*open))
      e.status = TagStatus::kConverged;
  } else if (e.status == TagStatus::kConverged && (now - found->second.last_read).seconds() > stale_after_s_) {
    e.status = TagStatus::kStale;
  }
  e.time = now;
  return e;
}

std::vector<Epc> TagMap::tags() const {
  std::vector<Epc> all;
  for (const auto& [epc, kept] : kept_) all.push_back(epc);
  return all;
}

}  // namespace rfmvo
