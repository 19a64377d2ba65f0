#include "evaluate/alignment.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "base/assert.hpp"

namespace rfmvo::evaluate {
namespace {

constexpr std::size_t kMinPairs = 3;  // three points fix a rotation

struct Means {
  Eigen::Vector3d estimated = Eigen::Vector3d::Zero();
  Eigen::Vector3d truth = Eigen::Vector3d::Zero();
};

Means means_of(const std::vector<PosePair>& pairs) {
  Means means;
  for (const PosePair& pair : pairs) {
    means.estimated += pair.estimated.t;
    means.truth += pair.truth.t;
  }
  const double n = static_cast<double>(pairs.size());
  return {means.estimated / n, means.truth / n};
}

}  // namespace

// S. Umeyama, "Least-squares estimation of transformation parameters between two point patterns",
// IEEE PAMI 13(4), 1991, eq. (34) to (43).
std::optional<Similarity> align(const std::vector<PosePair>& pairs, const AlignmentOptions& options) {
  RFMVO_ASSERT(!options.with_scale || options.orientation_weight_m2 == 0.0);
  if (pairs.size() < kMinPairs) return std::nullopt;
  const Means means = means_of(pairs);
  const double n = static_cast<double>(pairs.size());

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance = 0.0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d e = pair.estimated.t - means.estimated;
    covariance += (pair.truth.t - means.truth) * e.transpose() / n;
    variance += e.squaredNorm() / n;
    covariance +=
        (options.orientation_weight_m2 / n) * (pair.truth.R * pair.estimated.R.conjugate()).toRotationMatrix();
  }
  if (!(variance > 0.0) || !covariance.allFinite()) return std::nullopt;

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign.z() = -1.0;

  Similarity result;
  const Eigen::Matrix3d R = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  result.T.R = Eigen::Quaterniond(R).normalized();
  if (options.with_scale) result.scale = svd.singularValues().dot(sign) / variance;
  result.T.t = means.truth - result.scale * (result.T.R * means.estimated);
  return result;
}

double position_rmse_m(const std::vector<PosePair>& pairs, const Similarity& alignment) {
  double sum = 0.0;
  for (const PosePair& pair : pairs) sum += (alignment * pair.estimated.t - pair.truth.t).squaredNorm();
  return pairs.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(pairs.size()));
}

double spread_off_line_m(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) return 0.0;
  const Means means = means_of(pairs);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d d = pair.truth.t - means.truth;
    covariance += d * d.transpose() / static_cast<double>(pairs.size());
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance);
  return std::sqrt(svd.singularValues()[1]);
}

std::optional<Rigid3> truth_at(const std::vector<simulate::TruePose>& trajectory, DeviceTime time) {
  if (trajectory.empty()) return std::nullopt;
  const auto& first = trajectory.front();
  const auto& last = trajectory.back();
  if (time < first.time) return first.time - time <= kTimeSlack ? std::optional(first.T_W_C) : std::nullopt;
  if (time > last.time) return time - last.time <= kTimeSlack ? std::optional(last.T_W_C) : std::nullopt;

  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), time,
                                      [](const simulate::TruePose& pose, DeviceTime t) { return pose.time < t; });
  if (after->time == time) return after->T_W_C;
  const auto before = after - 1;
  const Duration gap = after->time - before->time;
  if (gap > kMaxTruthGap) return std::nullopt;
  return interpolate(before->T_W_C, after->T_W_C, (time - before->time).seconds() / gap.seconds());
}

}  // namespace rfmvo::evaluate
