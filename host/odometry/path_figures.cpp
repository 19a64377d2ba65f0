#include "odometry/path_figures.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/units.hpp"

namespace rfmvo::odometry {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct Sample {
  double t_s = 0.0;
  evaluate::PosePair pair;  // estimated: in units of V
  Matrix6d motion_covariance;
};
using Segment = std::vector<Sample>;

struct Sum {
  double total = 0.0;
  int count = 0;
  void add(double x) {
    total += x;
    ++count;
  }
  [[nodiscard]] double mean() const { return count > 0 ? total / count : 0.0; }
};

struct Sums {
  Sum sim3, se3, rpe_frame, rpe_second, rpe_second_deg, step, nees;
  std::vector<double> half_scales;
};

std::map<std::uint32_t, Segment> segments_of(const std::vector<PathPose>& path,
                                             const std::vector<simulate::TruePose>& truth) {
  std::map<std::uint32_t, Segment> segments;
  for (const PathPose& pose : path) {
    const auto T_W_C = evaluate::truth_at(truth, pose.time);
    if (!T_W_C) continue;
    const double t_s = (pose.time - path.front().time).seconds();
    segments[pose.segment].push_back({t_s, {{pose.T_V_C.R_V_C, pose.T_V_C.p_V_C}, *T_W_C}, pose.motion_covariance});
  }
  return segments;
}

std::vector<evaluate::PosePair> pairs_of(const Segment& segment, std::size_t from, std::size_t to) {
  std::vector<evaluate::PosePair> pairs;
  for (std::size_t i = from; i < to; ++i) pairs.push_back(segment[i].pair);
  return pairs;
}

double path_of(const Segment& segment, std::size_t from, std::size_t to) {
  double path_m = 0.0;
  for (std::size_t i = from + 1; i < to; ++i) path_m += (segment[i].pair.truth.t - segment[i - 1].pair.truth.t).norm();
  return path_m;
}

// Estimated motion from a to b against the true one, the estimate in metres.
Rigid3 motion_error(const Sample& a, const Sample& b, double scale) {
  const Rigid3 from{a.pair.estimated.R, scale * a.pair.estimated.t}, to{b.pair.estimated.R, scale * b.pair.estimated.t};
  return (a.pair.truth.inverse() * b.pair.truth).inverse() * (from.inverse() * to);
}

// First pose at or after t_s.
std::size_t at_or_after(const Segment& segment, double t_s) {
  return static_cast<std::size_t>(
      std::lower_bound(segment.begin(), segment.end(), t_s, [](const Sample& s, double t) { return s.t_s < t; }) -
      segment.begin());
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::size_t poses_per_second(const Segment& segment) {
  std::vector<double> gaps_s;
  for (std::size_t i = 1; i < segment.size(); ++i) gaps_s.push_back(segment[i].t_s - segment[i - 1].t_s);
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(1.0 / std::max(median_of(gaps_s), 1e-3))));
}

void add_relative(const Segment& s, double scale, Sums& sums) {
  for (std::size_t i = 1; i < s.size(); ++i) sums.rpe_frame.add(motion_error(s[i - 1], s[i], scale).t.squaredNorm());
  const std::size_t second = poses_per_second(s);
  for (std::size_t i = 0; i + second < s.size(); ++i) {
    const Rigid3 error = motion_error(s[i], s[i + second], scale);
    sums.rpe_second.add(error.t.squaredNorm());
    sums.rpe_second_deg.add(std::pow(deg_from_rad(so3_log(error.R).norm()), 2));
  }
  constexpr double kJitter_s = 0.25 * kStep_s;  // frames need not fall on the tenth of a second
  for (std::size_t i = 0; i < s.size();) {
    const std::size_t k = at_or_after(s, s[i].t_s + kStep_s - 1e-6);
    if (k == s.size()) break;
    if (s[k].t_s - s[i].t_s < kStep_s + kJitter_s) sums.step.add(motion_error(s[i], s[k], scale).t.squaredNorm());
    i = k;
  }
}

void add_half_scales(const Segment& s, Sums& sums) {
  for (double t = s.front().t_s; t + 2.0 * kHalfWindow_s <= s.back().t_s + 1e-6; t += kHalfStride_s) {
    const std::size_t a = at_or_after(s, t - 1e-6), b = at_or_after(s, t + kHalfWindow_s - 1e-6);
    const std::size_t c = std::min(s.size(), at_or_after(s, t + 2.0 * kHalfWindow_s - 1e-6) + 1);
    const std::size_t joint = std::min(b + 1, s.size());
    if (path_of(s, a, joint) < kMinHalfPath_m || path_of(s, b, c) < kMinHalfPath_m) continue;
    const auto first = evaluate::align(pairs_of(s, a, joint), {.with_scale = true});
    const auto second = evaluate::align(pairs_of(s, b, c), {.with_scale = true});
    if (first && second && first->scale > 0.0 && second->scale > 0.0)
      sums.half_scales.push_back(std::abs(std::log(first->scale / second->scale)));
  }
}

// Adjoint of the motion T: a small motion before it, seen after it (rotation first).
Matrix6d adjoint(const Rigid3& T) {
  const Eigen::Matrix3d R = T.R.toRotationMatrix();
  Matrix6d A = Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = R;
  A.bottomRightCorner<3, 3>() = R;
  A.bottomLeftCorner<3, 3>() = skew(T.t) * R;
  return A;
}

// The covariance of a motion of many frames: those of the frames, each carried to the end's camera frame.
void add_nees(const Segment& s, double scale, Sums& sums) {
  const std::size_t second = poses_per_second(s);
  for (std::size_t i = 0; i + second < s.size(); i += std::max<std::size_t>(1, second / 3)) {
    Matrix6d covariance = Matrix6d::Zero();
    const Rigid3 end{s[i + second].pair.estimated.R, s[i + second].pair.estimated.t};
    for (std::size_t k = i + 1; k <= i + second; ++k) {
      const Rigid3 here{s[k].pair.estimated.R, s[k].pair.estimated.t};
      const Matrix6d A = adjoint(end.inverse() * here);
      covariance += A * s[k].motion_covariance * A.transpose();
    }
    const Eigen::LDLT<Matrix6d> ldlt(covariance);
    if (!ldlt.isPositive() || !(ldlt.vectorD().minCoeff() > 0.0)) continue;
    const Rigid3 error = motion_error(s[i], s[i + second], scale);
    Vector6d e;
    e << so3_log(error.R), error.t / scale;
    sums.nees.add(e.dot(ldlt.solve(e)) / 6.0);
  }
}

double root_mean(const Sum& sum) { return std::sqrt(sum.mean()); }

}  // namespace

std::optional<PathFigures> path_figures(const std::vector<PathPose>& path,
                                        const std::vector<simulate::TruePose>& truth) {
  PathFigures figures;
  Sums sums;
  std::size_t longest = 0;
  for (const auto& [id, segment] : segments_of(path, truth)) {
    if (segment.size() < kMinPoses) continue;
    const auto pairs = pairs_of(segment, 0, segment.size());
    const auto sim3 = evaluate::align(pairs, {.with_scale = true}), se3 = evaluate::align(pairs, {});
    if (!sim3 || !se3 || !(sim3->scale > 0.0)) continue;
    for (const auto& pair : pairs) {
      sums.sim3.add((*sim3 * pair.estimated.t - pair.truth.t).squaredNorm());
      sums.se3.add((*se3 * pair.estimated.t - pair.truth.t).squaredNorm());
    }
    figures.path_m += path_of(segment, 0, segment.size());
    if (segment.size() > longest) figures.scale_m_per_unit = sim3->scale;
    longest = std::max(longest, segment.size());
    add_relative(segment, sim3->scale, sums);
    add_half_scales(segment, sums);
    add_nees(segment, sim3->scale, sums);
  }
  if (longest == 0) return std::nullopt;
  figures.poses = sums.sim3.count;
  figures.ate_sim3_m = root_mean(sums.sim3);
  figures.ate_se3_m = root_mean(sums.se3);
  figures.rpe_frame_m = root_mean(sums.rpe_frame);
  figures.rpe_second_m = root_mean(sums.rpe_second);
  figures.rpe_second_deg = root_mean(sums.rpe_second_deg);
  figures.step_noise_m = root_mean(sums.step) / std::sqrt(3.0);
  if (!sums.half_scales.empty()) figures.half_scale_median = median_of(sums.half_scales);
  if (sums.nees.count > 0) figures.nees = sums.nees.mean();
  return figures;
}

}  // namespace rfmvo::odometry
