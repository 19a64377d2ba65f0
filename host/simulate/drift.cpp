#include "simulate/drift.hpp"

#include <array>
#include <cmath>

#include "base/units.hpp"
#include "simulate/random.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kScaleMin_m = 0.5, kScaleMax_m = 3.0;  // metres per unit of V, drawn log-uniformly
constexpr int kInliers = 120;                           // typical number of tracks
// What an odometry's own optimisation claims at best; keeps the covariance invertible.
constexpr double kWhiteFloor_m = 1e-4;
constexpr double kRotationFloor_rad = 2e-4;

const std::array<DriftClass, 5>& classes() {
  static const std::array<DriftClass, 5> table{{
      {"PERFECT", 0.0, 0.0, 0.0, 0.0},
      {"BEST", 0.5e-3, 0.0015, rad_from_deg(0.1), 0.0},
      {"NOMINAL", 1.0e-3, 0.0035, rad_from_deg(0.25), 0.0},
      {"DEGRADED", 2.5e-3, 0.010, rad_from_deg(0.5), rad_from_deg(0.3)},
      {"BAD", 7.0e-3, 0.035, rad_from_deg(1.0), rad_from_deg(2.0)},
  }};
  return table;
}

Eigen::Vector3d normal3(Random& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

Eigen::Matrix<double, 6, 6> motion_covariance(const DriftClass& c, double step_m, double gamma) {
  const double rotation = std::pow(c.rotation_walk_rad_per_sqrt_m, 2) * step_m +
                          std::pow(c.rotation_bias_rad_per_m * step_m, 2) + std::pow(kRotationFloor_rad, 2);
  // The white part enters the difference of two poses twice; e counts with its spread after one metre.
  const double white = std::max(c.white_m, kWhiteFloor_m);
  const double translation = 2.0 * white * white + std::pow(c.scale_walk_per_sqrt_m * step_m, 2);
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  covariance.diagonal().head<3>().setConstant(rotation);
  covariance.diagonal().tail<3>().setConstant(translation / (gamma * gamma));
  return covariance;
}

}  // namespace

std::vector<std::string> vo_class_names() {
  std::vector<std::string> names;
  for (const DriftClass& c : classes()) names.push_back(c.name);
  return names;
}

std::optional<DriftClass> find_drift_class(const std::string& name) {
  for (const DriftClass& c : classes()) {
    if (c.name == name) return c;
  }
  return std::nullopt;
}

DriftedPoses drift(const std::vector<TruePose>& truth, const DriftClass& c, std::uint64_t seed, std::uint64_t part) {
  Random scale_random(seed, "odometry scale", part);
  Random random(seed, "odometry drift", part);
  DriftedPoses result;
  const double gamma = std::exp(scale_random.uniform(std::log(kScaleMin_m), std::log(kScaleMax_m)));
  const double bias_sign = scale_random.uniform() < 0.5 ? -1.0 : 1.0;
  result.scale_m_per_unit = gamma;

  UnscaledPose pose;         // without n
  double scale_error = 0.0;  // e
  Eigen::Quaterniond R_theta = Eigen::Quaterniond::Identity();
  const Eigen::Quaterniond R_V0_W = truth.front().T_W_C.R.conjugate();  // V0: V without drift
  for (std::size_t k = 0; k < truth.size(); ++k) {
    double step_m = 0.0;
    if (k > 0) {
      const Eigen::Vector3d step_V0 = R_V0_W * (truth[k].T_W_C.t - truth[k - 1].T_W_C.t);
      step_m = step_V0.norm();
      pose.p_V_C += (1.0 + scale_error) / gamma * (R_theta * step_V0);
      scale_error += c.scale_walk_per_sqrt_m * std::sqrt(step_m) * random.normal();
      const Eigen::Vector3d down_V0 = (R_V0_W * truth[k].T_W_C.R) * Eigen::Vector3d::UnitY();
      const Eigen::Vector3d turn = c.rotation_walk_rad_per_sqrt_m * std::sqrt(step_m) * normal3(random) +
                                   bias_sign * c.rotation_bias_rad_per_m * step_m * down_V0;
      R_theta = (R_theta * so3_exp(turn)).normalized();
    }
    const Eigen::Vector3d white_V = c.white_m / gamma * normal3(random);

    CameraPose out;
    out.time = truth[k].time;
    out.status = VoStatus::kTracking;
    out.inliers = kInliers;
    out.T_V_C.R_V_C = (R_theta * (R_V0_W * truth[k].T_W_C.R)).normalized();
    out.T_V_C.p_V_C = pose.p_V_C + (k > 0 ? white_V : Eigen::Vector3d::Zero());
    out.motion_covariance = motion_covariance(c, step_m, gamma);
    result.poses.push_back(out);
  }
  return result;
}

}  // namespace rfmvo::simulate
