#include "vision/two_view.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "base/units.hpp"
#include "vision/triangulation.hpp"

namespace rfmvo {
namespace {

constexpr double kConfidence = 0.999;
constexpr int kMaxTries =
    200;  // enough for half of the pairs wrong: 1 - (1 - 1/32)^200 = 0.998; nonsense must not cost more
constexpr double kSamePose_rad = 1.0 * kPi / 180.0;
constexpr double kSameDirection_rad = 5.0 * kPi / 180.0;
// Below this the depth of a pair says nothing; such points neither vote for nor against.
constexpr double kMinVoteParallax_rad = 0.3 * kPi / 180.0;

ViewPose pose_from(const cv::Mat& R, const cv::Mat& t, double sign) {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rotation(i, j) = R.at<double>(i, j);
    translation(i) = t.at<double>(i);
  }
  return {Eigen::Quaterniond(rotation).normalized(), sign * translation.normalized()};
}

void add_essential(const std::vector<cv::Point2d>& a, const std::vector<cv::Point2d>& b, double threshold,
                   std::vector<ViewPose>& poses) {
  // OpenCV seeds its RANSAC with a constant: same points, same answer.
  const cv::Mat E =
      cv::findEssentialMat(a, b, cv::Mat::eye(3, 3, CV_64F), cv::RANSAC, kConfidence, threshold, kMaxTries);
  for (int k = 0; k + 3 <= E.rows; k += 3) {
    cv::Mat R1, R2, t;
    cv::decomposeEssentialMat(E.rowRange(k, k + 3), R1, R2, t);
    for (const cv::Mat& R : {R1, R2}) {
      for (const double sign : {1.0, -1.0}) poses.push_back(pose_from(R, t, sign));
    }
  }
}

void add_homography(const std::vector<cv::Point2d>& a, const std::vector<cv::Point2d>& b, double threshold,
                    std::vector<ViewPose>& poses) {
  const cv::Mat H = cv::findHomography(a, b, cv::RANSAC, threshold, cv::noArray(), 500, kConfidence);
  if (H.empty()) return;
  std::vector<cv::Mat> R, t, normals;
  cv::decomposeHomographyMat(H, cv::Mat::eye(3, 3, CV_64F), R, t, normals);
  for (std::size_t k = 0; k < R.size(); ++k) {
    if (cv::norm(t[k]) < 1e-6) continue;
    for (const double sign : {1.0, -1.0}) poses.push_back(pose_from(R[k], t[k], sign));
  }
}

// How far the second point is from the line on which a pure translation t moves the first.
double translation_error(const PointPair& pair, const Eigen::Vector3d& t) {
  const Eigen::Vector3d line = t.cross(pair.first.homogeneous());
  const double length = line.head<2>().norm();
  return length > 0.0 ? std::abs(line.dot(pair.second.homogeneous())) / length : 0.0;
}

// The direction with the smallest sum of capped errors among those that two pairs define, over pairs
// from all parts of the list.
Eigen::Vector3d elected_direction(const std::vector<Eigen::Vector3d>& normals, std::span<const PointPair> pairs,
                                  double threshold) {
  Eigen::Vector3d best = Eigen::Vector3d::UnitX();
  double best_cost = std::numeric_limits<double>::infinity();
  const std::size_t half = pairs.size() / 2;
  for (std::size_t i = 0; i < half; ++i) {
    const Eigen::Vector3d t = normals[i].cross(normals[i + half]);
    if (t.norm() < 1e-12) continue;
    double cost = 0.0;
    for (const PointPair& pair : pairs) cost += std::min(translation_error(pair, t.normalized()), threshold);
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = t.normalized();
  }
  return best;
}

// A cart that passes a shelf hardly turns between two views, and a narrow lens confuses a turn with a
// sideways step: so the pose without any turn always stands for election. Its direction is the one most
// nearly at right angles to all n2 x n1 of the pairs inside the threshold.
void add_translation(std::span<const PointPair> pairs, double threshold, std::vector<ViewPose>& poses) {
  std::vector<Eigen::Vector3d> normals;
  for (const PointPair& pair : pairs) normals.push_back(pair.second.homogeneous().cross(pair.first.homogeneous()));
  Eigen::Vector3d t = elected_direction(normals, pairs, threshold);
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (translation_error(pairs[i], t) < threshold) M.noalias() += normals[i] * normals[i].transpose();
  }
  t = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(M).eigenvectors().col(0);
  for (const double sign : {1.0, -1.0}) poses.push_back({Eigen::Quaterniond::Identity(), sign * t});
}

TwoViewHypothesis vote(std::span<const PointPair> pairs, const ViewPose& T_C2_C1, double focal_px, double gate_px) {
  TwoViewHypothesis h{T_C2_C1, 0.0, 0};
  for (const PointPair& pair : pairs) {
    const SightLine lines[2] = {{ViewPose{}, pair.first}, {T_C2_C1, pair.second}};
    const auto p = triangulate(lines, kMinVoteParallax_rad, focal_px, gate_px);
    if (!p) continue;
    const Eigen::Vector2d e1 = focal_px * (p->hnormalized() - pair.first);
    const Eigen::Vector2d e2 = focal_px * ((T_C2_C1 * *p).hnormalized() - pair.second);
    h.score += std::max(0.0, gate_px * gate_px - 0.5 * (e1.squaredNorm() + e2.squaredNorm()));
    ++h.inliers;
  }
  return h;
}

bool same(const ViewPose& a, const ViewPose& b) {
  return a.R_C_V.angularDistance(b.R_C_V) < kSamePose_rad && a.t_C_V.dot(b.t_C_V) > std::cos(kSameDirection_rad);
}

}  // namespace

std::vector<TwoViewHypothesis> two_view_hypotheses(std::span<const PointPair> pairs, double focal_px, double gate_px) {
  constexpr std::size_t kLeastPairs = 12;
  if (pairs.size() < kLeastPairs) return {};
  std::vector<cv::Point2d> a, b;
  for (const PointPair& pair : pairs) {
    a.emplace_back(pair.first.x(), pair.first.y());
    b.emplace_back(pair.second.x(), pair.second.y());
  }
  std::vector<ViewPose> poses;
  add_essential(a, b, 0.5 * gate_px / focal_px, poses);
  add_homography(a, b, gate_px / focal_px, poses);
  add_translation(pairs, gate_px / focal_px, poses);
  std::vector<TwoViewHypothesis> all;
  for (const ViewPose& pose : poses) all.push_back(vote(pairs, pose, focal_px, gate_px));
  std::stable_sort(all.begin(), all.end(), [](const auto& x, const auto& y) { return x.score > y.score; });
  std::vector<TwoViewHypothesis> distinct;
  for (const TwoViewHypothesis& h : all) {
    const auto is_same = [&h](const TwoViewHypothesis& d) { return same(d.T_C2_C1, h.T_C2_C1); };
    if (std::none_of(distinct.begin(), distinct.end(), is_same)) distinct.push_back(h);
  }
  return distinct;
}

double rotation_only_residual_px(std::span<const PointPair> pairs, double focal_px) {
  if (pairs.empty()) return 0.0;
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (const PointPair& pair : pairs) {
    correlation += pair.second.homogeneous().normalized() * pair.first.homogeneous().normalized().transpose();
  }
  // Kabsch: the rotation that takes the first directions to the second.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  const Eigen::Matrix3d R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  std::vector<double> errors;
  for (const PointPair& pair : pairs) {
    errors.push_back(focal_px * ((R * pair.first.homogeneous()).hnormalized() - pair.second).norm());
  }
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

}  // namespace rfmvo
