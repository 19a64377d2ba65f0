// A handmade world for the tests of the joint estimator: a path with a turn, two antennas, tags, and the phases
// that geometry gives. Uses the product's data types but none of its phase or noise formulas.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "estimator/joint_problem.hpp"
#include "estimator/joint_solver.hpp"

namespace joint_scene {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kLight_m_s = 299792458.0;
inline constexpr double kReference_hz = 920e6;

inline double wavenumber_rad_m(double frequency_hz) { return 4.0 * kPi * frequency_hz / kLight_m_s; }
inline double frequency_term_rad_m(double frequency_hz) {
  return 4.0 * kPi * (frequency_hz - kReference_hz) / kLight_m_s;
}

inline Eigen::Vector3d random_vector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

inline Eigen::Quaterniond random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  return Eigen::Quaterniond(w, x, y, z).normalized();
}

// Matern 3/2 of the structured error plus white noise, written out once more.
inline Eigen::MatrixXd error_covariance(const std::vector<Eigen::Vector3d>& positions_m, double sigma_rad,
                                        double length_m, double white_rad2) {
  const auto n = static_cast<Eigen::Index>(positions_m.size());
  Eigen::MatrixXd K(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const double a =
          (positions_m[static_cast<std::size_t>(i)] - positions_m[static_cast<std::size_t>(j)]).norm() / length_m;
      K(i, j) = sigma_rad * sigma_rad * (1.0 + a) * std::exp(-a) + (i == j ? white_rad2 : 0.0);
    }
  return K;
}

// Central difference of a function of one number.
inline double slope(const std::function<double(double)>& f, double step) { return (f(step) - f(-step)) / (2.0 * step); }

struct World {
  rfmvo::JointProblem problem;
  rfmvo::JointState truth;
};

// A 3 m path that turns left by a quarter circle half way, camera looking along it (z forward), seen by odometry at
// 1/scale; two antennas at different heights to its left; tags on both sides. Phases are exact.
inline World make_world(int tags, int reads_per_chain, double scale) {
  constexpr double kKnotSpacing_m = 0.75, kStraight_m = 1.5, kRadius_m = 0.95;
  World w;
  rfmvo::JointState& s = w.truth;
  s.log_scale = std::log(scale);
  s.ports = {{0.0, 3.0, {-0.25, -0.10, 0.05}}, {1.1, 4.5, {-0.20, 0.35, -0.10}}};
  for (int t = 0; t < tags; ++t) {
    rfmvo::TagState tag;
    tag.p_W_X = {0.3 + 0.45 * t, t % 2 == 0 ? 1.9 : -1.4, 0.3 * (t % 3) - 0.2};
    tag.offset_rad = 0.7 * t - 1.0;
    tag.structured_sigma_rad = 0.2;
    s.tags.push_back(tag);
  }
  const auto place = [&](double arc_m) -> Eigen::Vector3d {
    if (arc_m <= kStraight_m) return {arc_m, 0.0, 0.0};
    const double angle = (arc_m - kStraight_m) / kRadius_m;
    return {kStraight_m + kRadius_m * std::sin(angle), kRadius_m * (1.0 - std::cos(angle)), 0.04 * angle};
  };
  const auto heading = [&](double arc_m) { return arc_m <= kStraight_m ? 0.0 : (arc_m - kStraight_m) / kRadius_m; };
  Eigen::Matrix3d R_B_C;  // camera axes (right, down, forward) in the cart's (forward, left, up)
  R_B_C << 0, 0, 1, -1, 0, 0, 0, -1, 0;

  const int knots = 5;
  s.knots.resize(knots);
  for (int k = 0; k + 1 < knots; ++k)
    w.problem.intervals.push_back(
        {(place((k + 1) * kKnotSpacing_m) - place(k * kKnotSpacing_m)) / scale, kKnotSpacing_m / scale});
  w.problem.reference_scale_m = scale;
  w.problem.flip_probability = w.problem.outlier_probability = 1e-12;
  for (const rfmvo::PortState& port : s.ports) {
    w.problem.priors.lever_arm_C.push_back(port.lever_arm_C);
    w.problem.priors.lever_arm_sigma_m.emplace_back(0.003, 0.003, 0.003);
    w.problem.priors.electrical_length_m.push_back(4.0);
    w.problem.priors.electrical_length_sigma_m.push_back(10.0);
  }
  for (int t = 0; t < tags; ++t) {
    auto& reads = w.problem.reads.emplace_back();
    for (int p = 0; p < 2; ++p)
      for (int i = 0; i < reads_per_chain; ++i) {
        const double arc_m = 3.0 * (i + 0.3 * p + 0.1 * t) / reads_per_chain;
        const double frequency_hz = kReference_hz + 0.5e6 * ((7 * i + 3 * t + p) % 9);
        rfmvo::JointRead read;
        read.geometry.n_W = place(arc_m) / scale;
        read.geometry.R_W_C = Eigen::AngleAxisd(heading(arc_m), Eigen::Vector3d::UnitZ()).toRotationMatrix() * R_B_C;
        read.geometry.velocity_W = (place(arc_m + 1e-5) - place(arc_m - 1e-5)) / 2e-5 * 0.5 / scale;  // 0.5 m/s
        const double turn_rad_s = arc_m > kStraight_m ? 0.5 / kRadius_m : 0.0;
        read.geometry.angular_velocity_C = {0.0, -turn_rad_s, 0.0};
        read.geometry.wavenumber_rad_m = wavenumber_rad_m(frequency_hz);
        read.geometry.frequency_term_rad_m = frequency_term_rad_m(frequency_hz);
        const rfmvo::PortState& port = s.ports[static_cast<std::size_t>(p)];
        read.p_W_A = place(arc_m) + read.geometry.R_W_C * port.lever_arm_C;
        const rfmvo::TagState& tag = s.tags[static_cast<std::size_t>(t)];
        const double phase = read.geometry.wavenumber_rad_m * (read.p_W_A - tag.p_W_X).norm() + tag.offset_rad +
                             port.offset_rad + read.geometry.frequency_term_rad_m * port.electrical_length_m;
        read.phase_rad = phase - 2.0 * kPi * std::floor(phase / (2.0 * kPi));
        read.white_rad2 = 0.05 * 0.05;
        read.port = p;
        read.knot = static_cast<int>(arc_m / kKnotSpacing_m);
        read.knot_fraction = arc_m / kKnotSpacing_m - read.knot;
        reads.push_back(read);
      }
  }
  return w;
}

inline rfmvo::SharedLayout layout_of(const rfmvo::JointState& state) {
  return {static_cast<int>(state.ports.size()), static_cast<int>(state.knots.size())};
}

// The state behind a column of SharedLayout.
inline double& shared_state(rfmvo::JointState& s, int column) {
  const rfmvo::SharedLayout layout = layout_of(s);
  if (column == rfmvo::SharedLayout::kLogScale) return s.log_scale;
  if (column == rfmvo::SharedLayout::kTimeOffset) return s.time_offset_s;
  if (column < layout.port(layout.ports)) {
    rfmvo::PortState& port = s.ports[static_cast<std::size_t>((column - layout.port(0)) / 5)];
    const int i = (column - layout.port(0)) % 5;
    return i == 0 ? port.offset_rad : i == 1 ? port.electrical_length_m : port.lever_arm_C[i - 2];
  }
  rfmvo::KnotState& knot = s.knots[static_cast<std::size_t>((column - layout.knot(1)) / 7 + 1)];
  const int i = (column - layout.knot(1)) % 7;
  return i < 3 ? knot.path_correction_W[i] : i < 6 ? knot.rotation_correction_W[i - 3] : knot.log_scale_drift;
}
inline double& tag_state(rfmvo::TagState& tag, int i) { return i < 3 ? tag.p_W_X[i] : tag.offset_rad; }

}  // namespace joint_scene
