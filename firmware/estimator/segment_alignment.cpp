#include "estimator/segment_alignment.hpp"

#include <Eigen/SVD>
#include <array>
#include <cmath>

namespace rfmvo {
namespace {

struct Pair {
  Eigen::Vector3d first, second;
  double weight = 0.0;
};

// Weighted least squares (Kabsch; Arun et al. 1987): the rotation from the SVD of the cross-covariance.
Rigid3 fit(const std::vector<Pair>& pairs) {
  double sum = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), second = Eigen::Vector3d::Zero();
  for (const Pair& p : pairs) {
    sum += p.weight;
    first += p.weight * p.first;
    second += p.weight * p.second;
  }
  first /= sum;
  second /= sum;
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  for (const Pair& p : pairs) cross += p.weight * (p.first - first) * (p.second - second).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d mirror = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) mirror[2] = -1.0;
  const Eigen::Quaterniond R(Eigen::Matrix3d(svd.matrixU() * mirror.asDiagonal() * svd.matrixV().transpose()));
  return {R, first - R * second};
}

// The expected start as six points at one arm's length about the camera: together they hold its position to
// position_sigma and, since a turn by sigma moves four of them by arm x sigma, its rotation to rotation_sigma.
void add_start(const ExpectedStart& start, std::vector<Pair>& pairs) {
  // 6 w = 1 / position_sigma^2 and, per axis, 4 w arm^2 = 1 / rotation_sigma^2.
  const double weight = 1.0 / (6.0 * start.position_sigma_m * start.position_sigma_m);
  const double arm_m = std::sqrt(1.5) * start.position_sigma_m / start.rotation_sigma_rad;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector3d p_C = side * arm_m * Eigen::Vector3d::Unit(axis);
      pairs.push_back({start.T_first_C * p_C, start.T_second_C * p_C, weight});
    }
}

constexpr double kElsewhere = 3.0;  // sigmas from which on a pair of places is no longer one tag

struct Responsibility {
  std::vector<Pair> pairs;
  double tags = 0.0, square_m2 = 0.0;
};

Responsibility expect(const std::vector<SharedTag>& tags, const Rigid3& T, double sigma_m) {
  Responsibility result;
  for (const SharedTag& tag : tags) {
    std::vector<Pair> pairs;
    double sum = std::exp(-0.5 * kElsewhere * kElsewhere);
    for (const PlaceShare& a : tag.first)
      for (const PlaceShare& b : tag.second) {
        const double squared = (a.p_m - T * b.p_m).squaredNorm() / (sigma_m * sigma_m);
        pairs.push_back({a.p_m, b.p_m, a.share * b.share * std::exp(-0.5 * squared)});
        sum += pairs.back().weight;
      }
    for (Pair& p : pairs) {
      p.weight /= sum;
      result.tags += p.weight;
      result.square_m2 += p.weight * (p.first - T * p.second).squaredNorm();
      p.weight /= sigma_m * sigma_m;
      result.pairs.push_back(p);
    }
  }
  return result;
}

}  // namespace

std::optional<Alignment> align_maps(const std::vector<SharedTag>& tags, const ExpectedStart& start,
                                    double tolerance_m) {
  constexpr std::array<double, 4> kTolerances{8.0, 4.0, 2.0, 1.0};  // of the last
  constexpr int kRounds = 6;
  Alignment best{start.T_first_C * start.T_second_C.inverse()};
  for (const double wider : kTolerances)
    for (int round = 0; round < kRounds; ++round) {
      std::vector<Pair> pairs = expect(tags, best.T_first_second, wider * tolerance_m).pairs;
      add_start(start, pairs);
      best.T_first_second = fit(pairs);
    }
  const Responsibility last = expect(tags, best.T_first_second, tolerance_m);
  constexpr double kFewest = 2.5;  // three, none of them quite sure
  if (last.tags < kFewest) return std::nullopt;
  best.tags = last.tags;
  best.residual_m = std::sqrt(last.square_m2 / last.tags);
  return best;
}

}  // namespace rfmvo
