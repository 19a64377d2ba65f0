#include "estimator/path_prior.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/rigid.hpp"

namespace rfmvo {
namespace {

// A cart that stands still still gives the walk this much room per interval.
constexpr double kMinInterval_m = 0.005;

// One normalised scalar residual with a handful of columns.
class Factor {
 public:
  void add(int column, double derivative) {
    if (column < 0) return;
    columns_[static_cast<std::size_t>(count_)] = column;
    values_[static_cast<std::size_t>(count_++)] = derivative;
  }
  // residual and derivatives are divided by sigma; returns the cost.
  double close(double residual, double sigma, Eigen::MatrixXd* H, Eigen::VectorXd* g) const {
    const double r = residual / sigma;
    for (int a = 0; H != nullptr && a < count_; ++a) {
      const int ca = columns_[static_cast<std::size_t>(a)];
      const double ja = values_[static_cast<std::size_t>(a)] / sigma;
      (*g)[ca] -= ja * r;
      for (int b = 0; b < count_; ++b) {
        const int cb = columns_[static_cast<std::size_t>(b)];
        if (cb <= ca) (*H)(ca, cb) += ja * values_[static_cast<std::size_t>(b)] / sigma;
      }
    }
    return 0.5 * r * r;
  }

 private:
  std::array<int, 16> columns_{};
  std::array<double, 16> values_{};
  int count_ = 0;
};

struct IntervalSigma {
  double drift, turn, position_m;
};
// Where the odometry was lost. The pieces are laid end to end by the tags that both saw (segment_alignment), to a few
// centimetres and per cent: this much room is nearly none of a prior.
constexpr IntervalSigma kGap{0.2, 0.3, 0.5};

// What the trapezium leaves of a random walk of density q over a length L has variance q^2 L^3 / 12.
IntervalSigma interval_sigma(const JointProblem& problem, std::size_t k) {
  if (problem.intervals[k].gap) return kGap;
  const JointPriors& priors = problem.priors;
  const double length_m = std::max(problem.reference_scale_m * problem.intervals[k].length_V, kMinInterval_m);
  const double walk = std::sqrt(length_m);
  const double density = std::max(priors.scale_walk_per_sqrt_m, priors.rotation_walk_rad_per_sqrt_m);
  return {priors.scale_walk_per_sqrt_m * walk, priors.rotation_walk_rad_per_sqrt_m * walk,
          std::hypot(priors.position_walk_m_per_sqrt_m * walk, density * walk * length_m / std::sqrt(12.0))};
}

int knot_column(const SharedLayout& layout, int knot, int offset) {
  return knot == 0 ? -1 : layout.knot(knot) + offset;
}

double add_interval(const JointProblem& problem, const JointState& state, const SharedLayout& layout, int k,
                    Eigen::MatrixXd* H, Eigen::VectorXd* g) {
  const KnotInterval& interval = problem.intervals[static_cast<std::size_t>(k)];
  const KnotState& a = state.knots[static_cast<std::size_t>(k)];
  const KnotState& b = state.knots[static_cast<std::size_t>(k) + 1];
  const IntervalSigma sigma = interval_sigma(problem, static_cast<std::size_t>(k));
  double cost = 0.0;

  Factor drift;
  drift.add(knot_column(layout, k, 6), -1.0);
  drift.add(knot_column(layout, k + 1, 6), 1.0);
  cost += drift.close(b.log_scale_drift - a.log_scale_drift, sigma.drift, H, g);
  for (int i = 0; i < 3; ++i) {
    Factor turn;
    turn.add(knot_column(layout, k, 3 + i), -1.0);
    turn.add(knot_column(layout, k + 1, 3 + i), 1.0);
    cost += turn.close(b.rotation_correction_W[i] - a.rotation_correction_W[i], sigma.turn, H, g);
  }

  // d(k+1) - d(k) - step (epsilon + theta x), trapezoidal in epsilon and theta.
  const Eigen::Vector3d step = std::exp(state.log_scale) * interval.step_W;
  const double epsilon = 0.5 * (a.log_scale_drift + b.log_scale_drift);
  const Eigen::Vector3d theta = 0.5 * (a.rotation_correction_W + b.rotation_correction_W);
  const Eigen::Vector3d moved = epsilon * step + theta.cross(step);
  const Eigen::Vector3d residual = b.path_correction_W - a.path_correction_W - moved;
  const Eigen::Matrix3d d_theta = 0.5 * skew(step);  // residual contains + step x theta
  for (int i = 0; i < 3; ++i) {
    Factor f;
    f.add(SharedLayout::kLogScale, -moved[i]);
    f.add(knot_column(layout, k, i), -1.0);
    f.add(knot_column(layout, k + 1, i), 1.0);
    f.add(knot_column(layout, k, 6), -0.5 * step[i]);
    f.add(knot_column(layout, k + 1, 6), -0.5 * step[i]);
    for (int j = 0; j < 3; ++j) {
      f.add(knot_column(layout, k, 3 + j), d_theta(i, j));
      f.add(knot_column(layout, k + 1, 3 + j), d_theta(i, j));
    }
    cost += f.close(residual[i], sigma.position_m, H, g);
  }
  return cost;
}

// Lever arms of independent errors D^-1 = diag(sigma^2) and one error common to all, axis by axis:
// (D^-1 + c^2 1 1^T)^-1 = D - D 1 1^T D c^2 / (1 + c^2 1^T D 1).
double add_lever_arm_prior(const JointPriors& priors, const JointState& state, const SharedLayout& layout,
                           Eigen::MatrixXd* H, Eigen::VectorXd* g) {
  const double common = std::pow(priors.lever_arms_common_sigma_m, 2.0);
  double cost = 0.0;
  for (int i = 0; i < 3; ++i) {
    Eigen::VectorXd D(layout.ports), residual(layout.ports);
    for (int p = 0; p < layout.ports; ++p) {
      const auto index = static_cast<std::size_t>(p);
      D[p] = std::pow(priors.lever_arm_sigma_m[index][i], -2.0);
      residual[p] = state.ports[index].lever_arm_C[i] - priors.lever_arm_C[index][i];
    }
    const Eigen::MatrixXd information =
        Eigen::MatrixXd(D.asDiagonal()) - common / (1.0 + common * D.sum()) * D * D.transpose();
    const Eigen::VectorXd pull = information * residual;
    cost += 0.5 * residual.dot(pull);
    for (int a = 0; H != nullptr && a < layout.ports; ++a) {
      (*g)[layout.port(a) + 2 + i] -= pull[a];
      for (int b = 0; b <= a; ++b) (*H)(layout.port(a) + 2 + i, layout.port(b) + 2 + i) += information(a, b);
    }
  }
  return cost;
}

}  // namespace

double add_path_prior(const JointProblem& problem, const JointState& state, const SharedLayout& layout,
                      Eigen::MatrixXd* H, Eigen::VectorXd* g) {
  const JointPriors& priors = problem.priors;
  double cost = 0.0;
  for (int k = 0; k + 1 < layout.knots; ++k) cost += add_interval(problem, state, layout, k, H, g);

  Factor time;
  time.add(SharedLayout::kTimeOffset, 1.0);
  cost += time.close(state.time_offset_s, priors.time_offset_sigma_s, H, g);
  for (int p = 0; p < layout.ports; ++p) {
    const auto index = static_cast<std::size_t>(p);
    const PortState& port = state.ports[index];
    if (p > 0) {
      // Offsets are angles: nothing is known, the factor only keeps the system definite.
      constexpr double kOffsetSigma_rad = 20.0;
      Factor offset;
      offset.add(layout.port(p), 1.0);
      cost += offset.close(port.offset_rad, kOffsetSigma_rad, H, g);
    } else if (H != nullptr) {
      (*H)(layout.port(0), layout.port(0)) += 1.0;  // fixed by definition
    }
    Factor length;
    length.add(layout.port(p) + 1, 1.0);
    cost += length.close(port.electrical_length_m - priors.electrical_length_m[index],
                         priors.electrical_length_sigma_m[index], H, g);
  }
  return cost + add_lever_arm_prior(priors, state, layout, H, g);
}

}  // namespace rfmvo
