#include "odometry/odometry_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

namespace rfmvo::odometry {
namespace {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

nlohmann::ordered_json cpu_of(const Run& run) {
  double sum_ms = 0.0;
  for (const double ms : run.cpu_ms) sum_ms += ms;
  const auto n = static_cast<double>(std::max<std::size_t>(run.cpu_ms.size(), 1));
  return {{"mean", sum_ms / n},
          {"p50", quantile(run.cpu_ms, 0.5)},
          {"p99", quantile(run.cpu_ms, 0.99)},
          {"max", quantile(run.cpu_ms, 1.0)},
          {"mean_with_decoding", 1e3 * run.total_cpu_s / n}};
}

void add_counts(const Run& run, nlohmann::ordered_json& j) {
  const auto count = [&run](VoStatus status) {
    return std::count_if(run.poses.begin(), run.poses.end(), [status](const auto& p) { return p.status == status; });
  };
  const auto first = std::find_if(run.poses.begin(), run.poses.end(), has_pose);
  const auto tracked = count(VoStatus::kTracking) + count(VoStatus::kDegraded);
  std::map<std::uint32_t, int> segments;
  for (const CameraPose& p : run.poses) {
    if (has_pose(p)) ++segments[p.segment];
  }
  j["frames"] = run.poses.size();
  j["initialising"] = count(VoStatus::kInitialising);
  j["tracking"] = count(VoStatus::kTracking);
  j["degraded"] = count(VoStatus::kDegraded);
  j["lost"] = count(VoStatus::kLost);
  j["segments"] = segments.size();
  j["start_s"] = first == run.poses.end() ? nlohmann::ordered_json(nullptr)
                                          : nlohmann::ordered_json((first->time - run.poses.front().time).seconds());
  j["tracked_share"] =
      first == run.poses.end() ? 0.0 : static_cast<double>(tracked) / static_cast<double>(run.poses.end() - first);
}

void add_path(const PathFigures& f, nlohmann::ordered_json& j) {
  j["ate_sim3_m"] = f.ate_sim3_m;
  j["ate_sim3_percent"] = f.ate_sim3_percent();
  j["ate_se3_m"] = f.ate_se3_m;
  j["path_m"] = f.path_m;
  j["scale_m_per_unit"] = f.scale_m_per_unit;
  j["rpe_frame_m"] = f.rpe_frame_m;
  j["rpe_second_m"] = f.rpe_second_m;
  j["rpe_second_deg"] = f.rpe_second_deg;
  j["step_noise_m"] = f.step_noise_m;
  j["half_scale_median"] =
      f.half_scale_median ? nlohmann::ordered_json(*f.half_scale_median) : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::vector<PathPose> live_path(const Run& run) {
  std::vector<PathPose> path;
  for (const CameraPose& p : run.poses) {
    if (has_pose(p)) path.push_back({p.time, p.segment, p.T_V_C, p.motion_covariance});
  }
  return path;
}

std::vector<PathPose> settled_path(const Run& run) {
  std::vector<PathPose> path;
  for (const SettledPose& p : run.settled) path.push_back({p.time, p.segment, p.T_V_C, {}});
  for (PathPose& p : path) p.motion_covariance.setZero();
  return path;
}

std::string to_tum(const std::vector<PathPose>& path) {
  std::string text = "# t tx ty tz qx qy qz qw: T_V_C, unscaled; every segment has a V of its own\n";
  for (std::size_t i = 0; i < path.size(); ++i) {
    const PathPose& p = path[i];
    if (i == 0 || p.segment != path[i - 1].segment) text += fmt::format("# segment {}\n", p.segment);
    const Eigen::Vector3d& t = p.T_V_C.p_V_C;
    const Eigen::Quaterniond& q = p.T_V_C.R_V_C;
    text += fmt::format("{}.{:09} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", p.time.ns / 1'000'000'000,
                        p.time.ns % 1'000'000'000, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

nlohmann::ordered_json report(const Run& run, const std::vector<simulate::TruePose>& truth) {
  nlohmann::ordered_json j;
  add_counts(run, j);
  j["cpu_ms"] = cpu_of(run);
  j["peak_memory_mb"] = run.peak_memory_mb;
  j["lens_k1"] = run.k1;
  j["lens_readout_ms"] = 1e3 * run.readout_s;
  if (truth.empty()) return j;
  if (const auto live = path_figures(live_path(run), truth)) {
    add_path(*live, j);
    j["nees_per_dof"] = live->nees ? nlohmann::ordered_json(*live->nees) : nlohmann::ordered_json(nullptr);
  }
  if (const auto settled = path_figures(settled_path(run), truth)) add_path(*settled, j["settled"]);
  return j;
}

}  // namespace rfmvo::odometry
