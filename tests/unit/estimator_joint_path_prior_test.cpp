#include <gtest/gtest.h>

#include "estimator/path_prior.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::layout_of;
using joint_scene::make_world;
using joint_scene::shared_state;
using joint_scene::World;

struct Normal {
  double cost = 0.0;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};

Normal normal_of(const World& w, const JointState& state) {
  const SharedLayout layout = layout_of(state);
  Normal n{0.0, Eigen::MatrixXd::Zero(layout.size(), layout.size()), Eigen::VectorXd::Zero(layout.size())};
  n.cost = add_path_prior(w.problem, state, layout, &n.H, &n.g);
  return n;
}

double cost_of(const World& w, const JointState& state) {
  return add_path_prior(w.problem, state, layout_of(state), nullptr, nullptr);
}

// Truth, its electrical lengths as the prior has them: every residual of the prior is zero.
World world_at_rest() {
  World w = make_world(0, 0, 1.6);
  for (PortState& port : w.truth.ports) {
    port.electrical_length_m = w.problem.priors.electrical_length_m[0];
    port.offset_rad = 0.0;
  }
  return w;
}

JointState disturbed(JointState state, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int c = 0; c < layout_of(state).size(); ++c)
    if (c != layout_of(state).port(0)) shared_state(state, c) += 0.01 * uniform(random);
  return state;
}

TEST(PathPrior, CostsNothingWhereEverythingIsAsExpected) {
  const World w = world_at_rest();
  EXPECT_NEAR(cost_of(w, w.truth), 0.0, 1e-20);
}

TEST(PathPrior, CostIsTheSameWithAndWithoutDerivatives) {
  std::mt19937 random(41);
  const World w = world_at_rest();
  const JointState state = disturbed(w.truth, random);
  EXPECT_EQ(cost_of(w, state), normal_of(w, state).cost);
}

TEST(PathPrior, GradientIsTheNumericDerivativeOfTheCost) {
  std::mt19937 random(42);
  const World w = world_at_rest();
  for (int n = 0; n < 5; ++n) {
    const JointState state = disturbed(w.truth, random);
    const Normal normal = normal_of(w, state);
    for (int c = 0; c < normal.g.size(); ++c) {
      if (c == layout_of(state).port(0)) continue;  // fixed by definition
      const double numeric = joint_scene::slope(
          [&](double h) {
            JointState s = state;
            shared_state(s, c) += h;
            return cost_of(w, s);
          },
          1e-5);
      // Quadratic but for the scale: the rounding of the cost (1e4 to 1e-16) over the step.
      EXPECT_NEAR(normal.g[c], -numeric, 1e-6 * (std::abs(numeric) + normal.cost)) << c;
    }
  }
}

TEST(PathPrior, InformationIsTheNumericHessianAtZeroResidual) {
  const World w = world_at_rest();
  const Normal normal = normal_of(w, w.truth);
  constexpr double kStep = 1e-4;
  const auto at = [&](int a, double ha, int b, double hb) {
    JointState s = w.truth;
    shared_state(s, a) += ha;
    shared_state(s, b) += hb;
    return cost_of(w, s);
  };
  for (int a = 0; a < normal.H.rows(); ++a)
    for (int b = 0; b <= a; ++b) {
      if (a == layout_of(w.truth).port(0) || b == layout_of(w.truth).port(0)) continue;
      const double numeric =
          (at(a, kStep, b, kStep) - at(a, kStep, b, -kStep) - at(a, -kStep, b, kStep) + at(a, -kStep, b, -kStep)) /
          (4.0 * kStep * kStep);
      EXPECT_NEAR(normal.H(a, b), numeric, 1e-6 * (1.0 + std::sqrt(normal.H(a, a) * normal.H(b, b)))) << a << " " << b;
    }
}

TEST(PathPrior, WritesTheLowerTriangleOnlyAndAdds) {
  std::mt19937 random(43);
  const World w = world_at_rest();
  const JointState state = disturbed(w.truth, random);
  const SharedLayout layout = layout_of(state);
  const Normal once = normal_of(w, state);
  for (int r = 0; r < layout.size(); ++r)
    for (int c = r + 1; c < layout.size(); ++c) EXPECT_EQ(once.H(r, c), 0.0);
  Eigen::MatrixXd H = Eigen::MatrixXd::Constant(layout.size(), layout.size(), 7.0);
  Eigen::VectorXd g = Eigen::VectorXd::Constant(layout.size(), 3.0);
  (void)add_path_prior(w.problem, state, layout, &H, &g);
  EXPECT_NEAR((H - once.H).array().maxCoeff(), 7.0, 1e-6);
  EXPECT_NEAR((H - once.H).array().minCoeff(), 7.0, 1e-6);
  EXPECT_NEAR((g - once.g).array().maxCoeff(), 3.0, 1e-6);
}

TEST(PathPrior, FixesTheOffsetOfTheFirstPort) {
  std::mt19937 random(44);
  const World w = world_at_rest();
  const JointState state = disturbed(w.truth, random);
  const Normal normal = normal_of(w, state);
  const int fixed = layout_of(state).port(0);
  EXPECT_EQ(normal.H(fixed, fixed), 1.0);
  EXPECT_EQ(normal.g[fixed], 0.0);
  EXPECT_EQ(normal.H.row(fixed).cwiseAbs().sum(), 1.0);
}

TEST(PathPrior, ATrueDriftCostsOnlyItsOwnWalk) {
  // Scale grows and the heading turns by a little at the first knot and stays so: d follows as its integral, to second
  // order in the angle. Only the first interval's walk is paid, and one interval that the trapezium sees half of.
  World w = world_at_rest();
  JointState state = w.truth;
  const double epsilon = 0.002;
  const Eigen::Vector3d theta(0.0, 0.0, 0.003);
  const double scale = std::exp(state.log_scale);
  for (std::size_t k = 1; k < state.knots.size(); ++k) {
    state.knots[k].log_scale_drift = epsilon;
    state.knots[k].rotation_correction_W = theta;
    const Eigen::Vector3d step = scale * w.problem.intervals[k - 1].step_W;
    const double share = k == 1 ? 0.5 : 1.0;
    state.knots[k].path_correction_W =
        state.knots[k - 1].path_correction_W + share * (epsilon * step + theta.cross(step));
  }
  const double walk_m = 0.75;
  const double expected =
      0.5 * epsilon * epsilon / (0.0035 * 0.0035 * walk_m) + 0.5 * theta.squaredNorm() / (0.0044 * 0.0044 * walk_m);
  EXPECT_NEAR(cost_of(w, state), expected, 1e-9);
}

TEST(PathPrior, AJumpOfThePositionCostsWhatTheTrapeziumAndTheKnotsLeave) {
  World w = world_at_rest();
  w.problem.priors.rotation_walk_rad_per_sqrt_m = 0.02;
  for (std::size_t k = 1; k < w.truth.knots.size(); ++k) w.truth.knots[k].path_correction_W = {0.001, 0.0, 0.0};
  const double variance = 0.001 * 0.001 * 0.75 + 0.02 * 0.02 * std::pow(0.75, 3) / 12.0;
  EXPECT_NEAR(cost_of(w, w.truth), 0.5 * 1e-6 / variance, 1e-9);
}

TEST(PathPrior, TheTrapeziumOfARandomWalkErrsByACubeOverTwelve) {
  // Monte Carlo of what the header's variance q^2 L^3 / 12 says: integral of a walk minus its trapezium.
  std::mt19937 random(45);
  std::normal_distribution<double> normal;
  constexpr int kWalks = 20000, kSteps = 100;
  constexpr double kDensity = 0.0035, kTravel_m = 0.8, kStep_m = kTravel_m / kSteps;
  double squares = 0.0;
  for (int n = 0; n < kWalks; ++n) {
    double walk = 0.0, integral = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double next = walk + kDensity * std::sqrt(kStep_m) * normal(random);
      integral += 0.5 * (walk + next) * kStep_m;
      walk = next;
    }
    squares += std::pow(integral - 0.5 * walk * kTravel_m, 2) / kWalks;
  }
  // sqrt(2 / 20000) = 1 % sampling error, five of them; 1 / kSteps^2 of discretisation.
  EXPECT_NEAR(squares / (kDensity * kDensity * std::pow(kTravel_m, 3) / 12.0), 1.0, 0.05);
}

// Two lever arms of own sigma s and common sigma c: a shift d of both has 2 d^2 / (s^2 + 2 c^2), of one against the
// other 2 d^2 / s^2, both halved.
TEST(PathPrior, LeverArmsMoveTogetherMoreEasilyThanApart) {
  World w = world_at_rest();
  w.problem.priors.lever_arms_common_sigma_m = 0.02;
  constexpr double kShift_m = 0.01, kOwn_m = 0.003;
  JointState together = w.truth, apart = w.truth;
  for (std::size_t p = 0; p < 2; ++p) {
    together.ports[p].lever_arm_C.y() += kShift_m;
    apart.ports[p].lever_arm_C.y() += p == 0 ? kShift_m : -kShift_m;
  }
  EXPECT_NEAR(cost_of(w, together), kShift_m * kShift_m / (kOwn_m * kOwn_m + 2.0 * 0.02 * 0.02), 1e-9);
  EXPECT_NEAR(cost_of(w, apart), kShift_m * kShift_m / (kOwn_m * kOwn_m), 1e-9);
}

// An arm that is known to 10 cm along the floor and to 5 mm in height gives way along the floor.
TEST(PathPrior, EachAxisOfALeverArmIsAsStiffAsItsOwnSigma) {
  World w = world_at_rest();
  const Eigen::Vector3d sigma_m(0.1, 0.005, 0.02);
  w.problem.priors.lever_arm_sigma_m[1] = sigma_m;
  constexpr double kShift_m = 0.01;
  for (int i = 0; i < 3; ++i) {
    JointState state = w.truth;
    state.ports[1].lever_arm_C[i] += kShift_m;
    EXPECT_NEAR(cost_of(w, state), 0.5 * std::pow(kShift_m / sigma_m[i], 2), 1e-9) << i;
  }
}

TEST(PathPrior, EachPortHasTheElectricalLengthThatItIsSaidToHave) {
  World w = world_at_rest();
  w.problem.priors.electrical_length_m[1] += 3.0;
  w.problem.priors.electrical_length_sigma_m[1] = 0.5;
  EXPECT_NEAR(cost_of(w, w.truth), 0.5 * std::pow(3.0 / 0.5, 2), 1e-9);
  w.truth.ports[1].electrical_length_m += 3.0;
  EXPECT_NEAR(cost_of(w, w.truth), 0.0, 1e-20);
}

TEST(PathPrior, GradientOfCommonLeverArmsIsNumeric) {
  std::mt19937 random(47);
  World w = world_at_rest();
  w.problem.priors.lever_arms_common_sigma_m = 0.02;
  const JointState state = disturbed(w.truth, random);
  const Normal n = normal_of(w, state);
  for (int p = 0; p < 2; ++p)
    for (int i = 2; i < 5; ++i) {
      const int c = layout_of(state).port(p) + i;
      const double slope = joint_scene::slope(
          [&](double h) {
            JointState s = state;
            shared_state(s, c) += h;
            return cost_of(w, s);
          },
          1e-6);
      EXPECT_NEAR(-n.g[c], slope, 1e-5 * (1.0 + std::abs(slope))) << p << ' ' << i;
    }
}

}  // namespace
}  // namespace rfmvo
