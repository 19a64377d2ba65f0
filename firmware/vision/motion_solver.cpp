#include "vision/motion_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "vision/reprojection.hpp"

namespace rfmvo {
namespace {

constexpr int kMaxIterations = 10;
constexpr double kStepDone = 1e-7;  // rad and units of V: far below a thousandth of a pixel
constexpr double kInitialDamping = 1e-4;
constexpr double kBehindCost_px2 = 1e4;  // of a point behind the camera: never better than any visible outlier
// The least scatter that is believed: KLT noise is 0.1..0.3 px.
constexpr double kSigmaFloor_px = 0.15;

struct Normal {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double cost = 0.0;
};

Normal linearise(std::span<const MotionObservation> observations, const std::vector<char>& use, const ViewPose& pose,
                 const MotionOptions& options) {
  Normal n;
  const Eigen::Matrix3d R = pose.R_C_V.toRotationMatrix();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!use[i]) continue;
    const Eigen::Vector3d p_C = R * observations[i].p_V + pose.t_C_V;
    const Reprojection r = reproject(p_C, observations[i].measured, options.focal_px * observations[i].scale);
    if (!r.in_front) {
      n.cost += kBehindCost_px2;
      continue;
    }
    const double error = r.error_px.norm();
    const double w = huber_weight(error, options.huber_px);
    const Eigen::Matrix<double, 2, 6> J = d_pose(r, p_C);
    const Eigen::Matrix<double, 2, 6> weighted = w * J;
    n.H.noalias() += weighted.transpose() * J;
    n.b.noalias() -= weighted.transpose() * r.error_px;
    n.cost += huber_cost(error, options.huber_px);
  }
  return n;
}

ViewPose descend(std::span<const MotionObservation> observations, const std::vector<char>& use, ViewPose pose,
                 const MotionOptions& options) {
  double damping = kInitialDamping;
  Normal n = linearise(observations, use, pose, options);
  for (int i = 0; i < kMaxIterations; ++i) {
    Matrix6d H = n.H;
    H.diagonal() += damping * n.H.diagonal() + Vector6d::Constant(1e-9);
    const Vector6d step = H.ldlt().solve(n.b);
    if (!step.allFinite()) break;
    const ViewPose candidate = moved(pose, step);
    const Normal m = linearise(observations, use, candidate, options);
    if (m.cost < n.cost) {
      pose = candidate;
      n = m;
      damping = std::max(damping * 0.1, 1e-9);
    } else {
      damping *= 10.0;
    }
    if (step.norm() < kStepDone || damping > 1e6) break;
  }
  return pose;
}

void judge(std::span<const MotionObservation> observations, const MotionOptions& options, std::vector<char>& use,
           MotionSolution& s) {
  s.error_px.assign(observations.size(), std::numeric_limits<double>::infinity());
  s.inliers = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Reprojection r =
        reproject(s.T_C_V * observations[i].p_V, observations[i].measured, options.focal_px * observations[i].scale);
    if (r.in_front) s.error_px[i] = r.error_px.norm();
    use[i] = s.error_px[i] <= options.gate_px;
    if (!use[i]) continue;
    ++s.inliers;
    sum += s.error_px[i] * s.error_px[i];
  }
  s.rms_px = s.inliers > 0 ? std::sqrt(sum / s.inliers) : 0.0;
}

}  // namespace

MotionSolution solve_motion(std::span<const MotionObservation> observations, const ViewPose& initial,
                            const MotionOptions& options) {
  MotionSolution s;
  std::vector<char> use(observations.size(), 1);
  s.T_C_V = descend(observations, use, initial, options);
  judge(observations, options, use, s);
  constexpr int kLeast = 6;  // three points fix a pose; twice as many show whether it is one
  if (s.inliers < kLeast) return s;
  s.T_C_V = descend(observations, use, s.T_C_V, options);
  judge(observations, options, use, s);
  if (s.inliers < kLeast) return s;
  const Normal n = linearise(observations, use, s.T_C_V, options);
  // Per axis: the squared error holds two components, six parameters are estimated.
  const double variance = s.rms_px * s.rms_px * s.inliers / (2.0 * s.inliers - 6.0);
  const Matrix6d inverse = n.H.ldlt().solve(Matrix6d::Identity());
  s.covariance = std::max(variance, kSigmaFloor_px * kSigmaFloor_px) * 0.5 * (inverse + inverse.transpose());
  return s;
}

MotionSolution solve_motion_globally(std::span<const MotionObservation> observations, const ViewPose& fallback,
                                     const MotionOptions& options) {
  constexpr std::size_t kLeast = 8;
  if (observations.size() < kLeast) return solve_motion(observations, fallback, options);
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> image;
  for (const MotionObservation& o : observations) {
    points.emplace_back(o.p_V.x(), o.p_V.y(), o.p_V.z());
    image.emplace_back(o.measured.x(), o.measured.y());
  }
  constexpr int kTries = 100;  // three good points of a half-bad set: 1 - (1 - 1/8)^100 > 0.999
  cv::Mat rotation, translation, inliers;
  // OpenCV seeds this RANSAC with a constant: same points, same answer.
  const bool found = cv::solvePnPRansac(points, image, cv::Matx33d::eye(), cv::noArray(), rotation, translation, false,
                                        kTries, static_cast<float>(2.0 * options.gate_px / options.focal_px), 0.999,
                                        inliers, cv::SOLVEPNP_AP3P);
  if (!found) return solve_motion(observations, fallback, options);
  ViewPose start;
  start.R_C_V = so3_exp({rotation.at<double>(0), rotation.at<double>(1), rotation.at<double>(2)});
  start.t_C_V = {translation.at<double>(0), translation.at<double>(1), translation.at<double>(2)};
  if (!start.R_C_V.coeffs().allFinite() || !start.t_C_V.allFinite()) start = fallback;
  return solve_motion(observations, start, options);
}

}  // namespace rfmvo
