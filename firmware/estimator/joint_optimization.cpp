#include "estimator/joint_optimization.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "estimator/distance_steps.hpp"
#include "estimator/spatial_power_spectrum.hpp"

namespace rfmvo {
namespace {

constexpr double kConverged_m = 1e-4;     // move of X_T between two outer iterations
constexpr double kConvergedScale = 1e-4;  // relative move of gamma
constexpr int kMaxSteps = 50;             // of Levenberg-Marquardt per outer iteration
constexpr double kMaxDamping = 1e12;
constexpr double kNegligible = 1e-10;     // decrease of the cost, relative: 1e-5 sigma of what is estimated
constexpr double kRunaway_m = 1e4;        // X_T goes to infinity where the data say "plane wave"
constexpr double kUnknownSigma_m = 10.0;  // 1 sigma of a direction the data say nothing about
constexpr double kUnknownLogScale = 1.0;  // same for the scale, relative

struct State {
  Eigen::Vector3d p_X_m;
  double gamma;
};

Eigen::Index usable_steps(std::span<const AntennaTerm> antennas) {
  Eigen::Index n = 0;
  for (const AntennaTerm& term : antennas) n += term.array.usable.count();
  return n;
}

// Eq. (19) of one step: distance to the tag and its derivatives with respect to (X_T, gamma).
struct Distance {
  double value_m;
  Eigen::RowVector4d derivative;
};
Distance distance(const AntennaArray& array, Eigen::Index i, const State& state) {
  const Eigen::Vector3d d = state.p_X_m - array.position_m(i, state.gamma);
  const double value = std::max(d.norm(), kMinTagDistance_m);
  Distance result{value, {}};
  result.derivative.head<3>() = d.transpose() / value;
  result.derivative(3) = -d.dot(array.camera_V.col(i)) / value;
  return result;
}

// Delta d_A of Eq. (19), all usable steps. The cycles are those of the current estimate.
Eigen::VectorXd measured_steps(std::span<const AntennaTerm> antennas, const State& state, bool fix_cycles) {
  Eigen::VectorXd steps(usable_steps(antennas));
  Eigen::Index row = 0;
  for (const AntennaTerm& term : antennas) {
    const AntennaArray& a = term.array;
    const double m_per_rad = a.wavelength_m / (2.0 * kTwoPi);
    for (Eigen::Index i = 0; i < a.steps(); ++i) {
      if (!a.usable(i)) continue;
      const double phase = a.phase_step_rad(i);
      double cycle = 0.0;
      if (fix_cycles) {
        // Differs from Eq. (21), (22): the cycle nearest to the predicted step, because the step's length
        // says nothing about its radial part.
        const double predicted_m = distance(a, i + 1, state).value_m - distance(a, i, state).value_m;
        cycle = kTwoPi * std::nearbyint((predicted_m / m_per_rad - phase) / kTwoPi);
      } else {
        const double length_m = (a.position_m(i + 1, state.gamma) - a.position_m(i, state.gamma)).norm();
        cycle = cycle_step_by_length_rad(phase, length_m, a.wavelength_m);
      }
      steps(row++) = m_per_rad * (phase + cycle);
    }
  }
  return steps;
}

bool sane(const State& state) {
  return std::isfinite(state.gamma) && state.gamma > 0.0 && state.p_X_m.allFinite() && state.p_X_m.norm() < kRunaway_m;
}

// Eq. (18) by Levenberg-Marquardt with Marquardt's scaling. The norm of a scalar in Eq. (18) is read
// as its square: the method minimises squares.
State minimise(std::span<const AntennaTerm> antennas, const Eigen::VectorXd& measured, State state) {
  std::vector<const AntennaArray*> arrays;
  for (const AntennaTerm& term : antennas) arrays.push_back(&term.array);
  DistanceSteps steps(arrays, measured);
  double cost = steps.cost_at(state.p_X_m, state.gamma);
  NormalEquations now = steps.normal_equations();
  double damping = 1e-3;
  for (int step = 0; step < kMaxSteps && damping < kMaxDamping; ++step) {
    const Eigen::Vector4d held = damping * now.matrix.diagonal().cwiseMax(1e-12);
    Eigen::Matrix4d normal = now.matrix;
    normal.diagonal() += held;
    const Eigen::Vector4d move = -normal.ldlt().solve(now.gradient);
    // What the linear model promises. Without it, a minimum reached to the last digit is left only by ever more
    // damping.
    const double promised = move.dot(held.cwiseProduct(move) - now.gradient);
    if (promised < kNegligible * cost) break;
    const State trial{state.p_X_m + move.head<3>(), state.gamma + move(3)};
    damping *= 10.0;
    if (!sane(trial)) continue;
    const double trial_cost = steps.cost_at(trial.p_X_m, trial.gamma);
    if (!(trial_cost < cost)) continue;
    const bool done = cost - trial_cost < kNegligible * cost;
    state = trial;
    cost = trial_cost;
    if (done) break;
    now = steps.normal_equations();
    damping = std::max(damping * 1e-2, 1e-9);
  }
  return state;
}

// sigma^2 (J'J)^-1 of (X_T, gamma). Directions without information get the stated ignorance instead of
// infinity: it is added as information.
Eigen::Matrix4d covariance_of(const DistanceResiduals& residuals, double sigma_m, double gamma) {
  Eigen::Vector4d unknown;
  unknown << Eigen::Vector3d::Constant(kUnknownSigma_m), kUnknownLogScale * gamma;
  const double variance = std::max(sigma_m * sigma_m, 1e-12);
  Eigen::Matrix4d information = residuals.jacobian.transpose() * residuals.jacobian / variance;
  // In units of `unknown`, so that the inverse is well scaled.
  information = unknown.asDiagonal() * information * unknown.asDiagonal();
  information.diagonal().array() += 1.0;
  return unknown.asDiagonal() * information.ldlt().solve(Eigen::Matrix4d::Identity()) * unknown.asDiagonal();
}

}  // namespace

double cycle_step_by_length_rad(double phase_step_rad, double antenna_step_m, double wavelength_m) {
  if (antenna_step_m <= 0.25 * wavelength_m) return cycle_step_rad(phase_step_rad);  // Eq. (21)
  const double size = std::abs(phase_step_rad);                                      // Eq. (22)
  if (size >= kPi || size == 0.0) return 0.0;                                        // the paper leaves zero open
  return phase_step_rad > 0.0 ? -kTwoPi : kTwoPi;
}

DistanceResiduals distance_residuals(std::span<const AntennaTerm> antennas, const Eigen::VectorXd& distance_step_m,
                                     const Eigen::Vector3d& p_X_m, double gamma) {
  const State state{p_X_m, gamma};
  DistanceResiduals out{Eigen::VectorXd(distance_step_m.size()), {distance_step_m.size(), 4}};
  Eigen::Index row = 0;
  for (const AntennaTerm& term : antennas) {
    Distance before = distance(term.array, 0, state);
    for (Eigen::Index i = 0; i < term.array.steps(); ++i) {
      const Distance after = distance(term.array, i + 1, state);
      if (term.array.usable(i)) {
        out.r_m(row) = distance_step_m(row) - (after.value_m - before.value_m);
        out.jacobian.row(row++) = before.derivative - after.derivative;
      }
      before = after;
    }
  }
  return out;
}

LineIntersection intersect_lines(std::span<const AntennaTerm> antennas, std::span<const IncidentAngles> angles,
                                 double gamma, bool fix_sphere_average) {
  std::vector<Line> lines;
  for (std::size_t j = 0; j < antennas.size(); ++j) {
    const AntennaArray& array = antennas[j].array;
    for (Eigen::Index i = 0; i < array.elements(); ++i) {
      AngleSums sums = antennas[j].others[static_cast<std::size_t>(i)];
      sums.add(angles[j], array.R_V_D);
      const Eigen::Vector3d u =
          fix_sphere_average ? sums.mean_direction_V() : array.R_V_D * direction_of(sums.mean_angles());
      lines.push_back({array.position_m(i, gamma), u});
    }
  }
  return nearest_point(lines);
}

ArraySolution joint_optimization(std::span<const AntennaTerm> antennas, double gamma, const JointOptions& options) {
  ArraySolution solution;
  State state{Eigen::Vector3d::Zero(), gamma};
  std::vector<AngleRefinement> refinements;
  for (const AntennaTerm& term : antennas) {
    solution.angles.push_back(term.angles);
    refinements.emplace_back(term.array, options.refine_step_rad, options.refine_range_rad);
  }
  for (int l = 0; l < options.max_iterations && !solution.converged; ++l) {
    const State last = state;
    for (std::size_t j = 0; j < antennas.size(); ++j)  // Eq. (16)
      solution.angles[j] = refinements[j].best(solution.angles[j], state.gamma);
    const LineIntersection start = intersect_lines(antennas, solution.angles, state.gamma, options.fix_sphere_average);
    state.p_X_m = start.point;
    if (!start.determined || !sane(state)) return solution;
    state = minimise(antennas, measured_steps(antennas, state, options.fix_cycles), state);  // Eq. (18)
    solution.iterations = l + 1;
    solution.converged = l > 0 && (state.p_X_m - last.p_X_m).norm() < kConverged_m &&
                         std::abs(state.gamma - last.gamma) < kConvergedScale * last.gamma;
  }
  const DistanceResiduals residuals =
      distance_residuals(antennas, measured_steps(antennas, state, options.fix_cycles), state.p_X_m, state.gamma);
  const auto n = static_cast<double>(residuals.r_m.size());
  if (n <= 4.0) return solution;  // as many unknowns as equations
  solution.sigma_m = std::sqrt(residuals.r_m.squaredNorm() / (n - 4.0));
  solution.covariance = covariance_of(residuals, solution.sigma_m, state.gamma);
  solution.p_X_m = state.p_X_m;
  solution.gamma = state.gamma;
  solution.found = sane(state) && solution.converged && state.p_X_m.norm() < kMaxTagRange_m;
  return solution;
}

}  // namespace rfmvo
