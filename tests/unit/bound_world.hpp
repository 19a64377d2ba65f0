// Small worlds for bounds: one camera with antennas on a line, tags beside it, reads where the test wants them.
#pragma once

#include "bound/bound.hpp"

namespace rfmvo::bound {

inline constexpr double kSpeed_m_s = 0.5;
inline constexpr double kFrequency_hz = 920e6;

// Along x, level, looking to +y: C has x forward, y down, z sideways, so tags have z_C = their distance.
inline Rigid3 straight_pose(double t_s) {
  Eigen::Matrix3d R_S_C;
  R_S_C << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return {Eigen::Quaterniond(R_S_C), {kSpeed_m_s * t_s, 0.0, 0.0}};
}

inline Rigid3 weaving_pose(double t_s) {
  const Rigid3 straight = straight_pose(t_s);
  const double x_m = straight.t.x();
  const Eigen::Quaterniond yaw(Eigen::AngleAxisd(0.3 * std::cos(1.5 * x_m), Eigen::Vector3d::UnitZ()));
  return {yaw * straight.R, {x_m, 0.2 * std::sin(1.5 * x_m), 0.03 * std::sin(2.5 * x_m)}};
}

// Nothing unknown but tags, offsets and what the settings add; white noise only.
inline World world_with(std::function<Rigid3(double)> pose, double length_m, std::vector<Eigen::Vector3d> lever_arms) {
  World world;
  world.T_S_C = std::move(pose);
  for (int k = 0; k <= 30.0 * length_m / kSpeed_m_s; ++k) world.frame_times_s.push_back(k / 30.0);
  world.lever_arms_C_m = std::move(lever_arms);
  world.lever_arm_sigma_m.setZero();
  world.structured.sigma_rad = 0.0;
  world.drift = *simulate::find_drift_class("PERFECT");
  return world;
}

inline void add_tag(World& world, const Eigen::Vector3d& p_S_X_m, int reads_per_port, double white_rad) {
  const std::size_t tag = world.tags.size();
  std::array<std::uint8_t, 12> bytes{};
  bytes[11] = static_cast<std::uint8_t>(tag);
  world.tags.push_back({Epc::from_bytes(bytes).value(), p_S_X_m});
  const double duration_s = world.frame_times_s.back();
  for (std::size_t port = 0; port < world.lever_arms_C_m.size(); ++port) {
    for (int i = 0; i < reads_per_port; ++i) {
      const double t_s = duration_s * (i + 0.5) / reads_per_port;
      world.reads.push_back({t_s, tag, port, kFrequency_hz, white_rad, kSpeed_m_s * t_s});
    }
  }
}

// Two antennas stacked 1 m, a weave, five tags.
inline World stacked_world(std::size_t tags = 5) {
  World world = world_with(weaving_pose, 4.0, {{0.0, -0.5, 0.0}, {0.0, 0.5, 0.0}});
  world.lever_arm_sigma_m.setConstant(0.005);
  world.structured.sigma_rad = 0.3;
  world.drift = *simulate::find_drift_class("NOMINAL");
  for (std::size_t n = 0; n < tags; ++n) {
    const double k = static_cast<double>(n);
    add_tag(world, {0.7 + 0.6 * k, 1.5 + 0.4 * std::sin(k), 0.5 * std::cos(2.0 * k)}, 20, 0.1);
  }
  return world;
}

}  // namespace rfmvo::bound
