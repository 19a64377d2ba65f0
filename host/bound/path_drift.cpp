#include "bound/path_drift.hpp"

#include <algorithm>
#include <cmath>

namespace rfmvo::bound {
namespace {

constexpr int kPerKnot = 4;

}  // namespace

PathDrift::PathDrift(const World& world, double knot_spacing_m) : T_S_C_(world.T_S_C) {
  follow(world);
  place_knots(knot_spacing_m, world.drift);
}

// A bias turns about the camera's vertical, as a wrong lens distortion does.
void PathDrift::follow(const World& world) {
  for (const double t_s : world.frame_times_s) {
    const Rigid3 T = world.T_S_C(t_s);
    Frame frame{t_s, 0.0, T.t, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    if (!frames_.empty()) {
      const Frame& last = frames_.back();
      const Eigen::Vector3d step_m = T.t - last.p_S_C_m;
      frame.arc_m = last.arc_m + step_m.norm();
      frame.bias_turn = last.bias_turn + step_m.norm() * (T.R * Eigen::Vector3d::UnitY());
      frame.bias_shift = last.bias_shift + last.bias_turn.cross(step_m);
    }
    frames_.push_back(frame);
  }
}

// A walk's steps, gathered in the middle of each interval.
void PathDrift::place_knots(double spacing_m, const simulate::DriftClass& drift) {
  const double length_m = frames_.back().arc_m;
  const int count = static_cast<int>(std::ceil(length_m / spacing_m));
  const double interval_m = length_m / std::max(count, 1);
  std::size_t k = 0;
  for (int j = 0; j < count; ++j) {
    const double arc_m = (j + 0.5) * interval_m;
    while (k + 2 < frames_.size() && frames_[k + 1].arc_m < arc_m) ++k;
    const Frame &a = frames_[k], &b = frames_[k + 1];
    const double f = (arc_m - a.arc_m) / (b.arc_m - a.arc_m);
    knots_.push_back({arc_m, a.p_S_C_m + f * (b.p_S_C_m - a.p_S_C_m)});
  }
  sigmas_ = Eigen::VectorXd::Zero(kPerKnot * count + 1);
  for (int j = 0; j < count; ++j) {
    sigmas_[kPerKnot * j] = drift.scale_walk_per_sqrt_m * std::sqrt(interval_m);
    sigmas_.segment<3>(kPerKnot * j + 1).setConstant(drift.rotation_walk_rad_per_sqrt_m * std::sqrt(interval_m));
  }
  sigmas_[kPerKnot * count] = drift.rotation_bias_rad_per_m;
}

PathDrift::Frame PathDrift::frame_at(double t_s) const {
  const auto after =
      std::upper_bound(frames_.begin(), frames_.end(), t_s, [](double t, const Frame& frame) { return t < frame.t_s; });
  if (after == frames_.begin()) return frames_.front();
  if (after == frames_.end()) return frames_.back();
  const Frame &a = *std::prev(after), &b = *after;
  const double f = (t_s - a.t_s) / (b.t_s - a.t_s);
  return {t_s, a.arc_m + f * (b.arc_m - a.arc_m), T_S_C_(t_s).t, a.bias_turn + f * (b.bias_turn - a.bias_turn),
          a.bias_shift + f * (b.bias_shift - a.bias_shift)};
}

double PathDrift::travelled_m(double t_s) const { return frame_at(t_s).arc_m; }

Eigen::Matrix<double, 6, Eigen::Dynamic> PathDrift::at(double t_s) const {
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, sigmas_.size());
  const Frame now = frame_at(t_s);
  for (std::size_t j = 0; j < knots_.size() && knots_[j].arc_m < now.arc_m; ++j) {
    const auto column = static_cast<Eigen::Index>(kPerKnot * j);
    const Eigen::Vector3d since_m = now.p_S_C_m - knots_[j].p_S_C_m;
    rows.block<3, 1>(0, column) = since_m;
    for (int i = 0; i < 3; ++i) {
      rows.block<3, 1>(0, column + 1 + i) = Eigen::Vector3d::Unit(i).cross(since_m);
      rows(3 + i, column + 1 + i) = 1.0;
    }
  }
  rows.block<3, 1>(0, sigmas_.size() - 1) = now.bias_shift;
  rows.block<3, 1>(3, sigmas_.size() - 1) = now.bias_turn;
  return rows;
}

}  // namespace rfmvo::bound
