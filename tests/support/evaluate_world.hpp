// A small true world and a result that is right, for tests of the evaluation.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "evaluate/alignment.hpp"
#include "evaluate/evaluation.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::testing {

inline constexpr double kMetresPerUnit = 0.37;
inline constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
inline constexpr std::int64_t kFrame_ns = 40'000'000;

inline DeviceTime frame_time(int i) { return {kStart_ns + i * kFrame_ns}; }

inline Epc epc_of(int i) {
  const std::vector<std::uint8_t> bytes = {0x30, 0x14, static_cast<std::uint8_t>(i / 256),
                                           static_cast<std::uint8_t>(i % 256)};
  return Epc::from_bytes(bytes).value();
}

// A cart that winds along an aisle: out of line in y by +-amplitude, and a little in z.
inline simulate::Truth winding_truth(int frames, int tags, double amplitude_m = 0.6) {
  simulate::Truth truth;
  truth.scale_m_per_unit = kMetresPerUnit;
  for (int i = 0; i < frames; ++i) {
    const double s = 0.02 * i;
    const Eigen::Vector3d p(s, amplitude_m * std::sin(s), 0.1 * amplitude_m * std::cos(0.7 * s));
    truth.trajectory.push_back({frame_time(i), {so3_exp({0.05 * std::sin(s), 0.02 * s, 0.4 * std::cos(s)}), p}});
  }
  for (int i = 0; i < tags; ++i) {
    truth.tags.push_back({epc_of(i), {0.3 + 0.01 * i, 1.5 + 0.1 * (i % 7), 0.2 * (i % 5)}});
  }
  return truth;
}

struct Perfect {
  Rigid3 T_W_truth{};         // the result's world
  double metric_error = 1.0;  // every length of the path times this
};

inline TagEstimate perfect_tag(const simulate::TrueTag& tag, const simulate::TruePose& closest, const Perfect& how) {
  TagEstimate estimate;
  estimate.epc = tag.epc;
  estimate.status = TagStatus::kConverged;
  estimate.p_W_X_m = how.T_W_truth * tag.p_W_X_m;
  estimate.covariance_m2 = 1e-4 * Eigen::Matrix3d::Identity();
  estimate.closest_approach = closest.time;
  estimate.p_C_X_m = closest.T_W_C.inverse() * tag.p_W_X_m;
  estimate.covariance_C_m2 = estimate.covariance_m2;
  estimate.reads = 40;
  return estimate;
}

inline Trajectory perfect_trajectory(const simulate::Truth& truth, const Perfect& how) {
  Trajectory trajectory;
  for (const auto& pose : truth.trajectory) {
    MetricPose metric;
    metric.time = pose.time;
    metric.T_W_C = how.T_W_truth * pose.T_W_C;
    metric.T_W_C.t *= how.metric_error;
    trajectory.poses.push_back(metric);
  }
  trajectory.time = truth.trajectory.back().time;
  return trajectory;
}

inline std::vector<Estimate> perfect_result(const simulate::Truth& truth, const Perfect& how = {}) {
  std::vector<Estimate> result;
  const Rigid3 T_V_truth = truth.trajectory.front().T_W_C.inverse();
  for (const auto& pose : truth.trajectory) {
    const Rigid3 T = T_V_truth * pose.T_W_C;
    CameraPose vo;
    vo.time = pose.time;
    vo.status = VoStatus::kTracking;
    vo.T_V_C = {T.R, T.t / truth.scale_m_per_unit};
    result.emplace_back(vo);
  }
  ScaleEstimate scale;
  scale.observable = true;
  scale.m_per_unit = truth.scale_m_per_unit * how.metric_error;
  scale.log_sigma = 0.01;
  result.emplace_back(scale);
  result.emplace_back(perfect_trajectory(truth, how));
  for (std::size_t i = 0; i < truth.tags.size(); ++i) {
    result.emplace_back(perfect_tag(truth.tags[i], truth.trajectory[i % truth.trajectory.size()], how));
  }
  return result;
}

inline Rigid3 some_motion() { return {so3_exp({0.4, -1.1, 2.0}), {12.0, -7.0, 3.0}}; }

inline simulate::Truth moved(simulate::Truth truth, const Rigid3& T) {
  for (auto& tag : truth.tags) tag.p_W_X_m = T * tag.p_W_X_m;
  for (auto& pose : truth.trajectory) pose.T_W_C = T * pose.T_W_C;
  return truth;
}

// A sample of the normal distribution with this covariance.
inline Eigen::Vector3d sample(const Eigen::Matrix3d& covariance, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return covariance.llt().matrixL() * Eigen::Vector3d(x, y, z);
}

// A perfect result with noise of 2 cm on the path and 5 cm on the tags.
inline std::vector<Estimate> noisy_result(const simulate::Truth& truth, const Perfect& how = {},
                                          std::uint64_t seed = 7) {
  std::mt19937_64 random(seed);
  std::vector<Estimate> result = perfect_result(truth, how);
  const Eigen::Matrix3d path = 4e-4 * Eigen::Matrix3d::Identity(), position = 25e-4 * Eigen::Matrix3d::Identity();
  for (Estimate& estimate : result) {
    if (auto* t = std::get_if<Trajectory>(&estimate)) {
      for (MetricPose& pose : t->poses) pose.T_W_C.t += sample(path, random);
    }
    if (auto* tag = std::get_if<TagEstimate>(&estimate)) {
      tag->p_W_X_m += sample(position, random);
      tag->p_C_X_m += sample(position, random);
    }
  }
  return result;
}

}  // namespace rfmvo::testing
