#include <gtest/gtest.h>

#include <algorithm>

#include "estimator/chain_whitening.hpp"
#include "estimator/joint_solver.hpp"
#include "estimator/path_prior.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::layout_of;
using joint_scene::make_world;
using joint_scene::random_vector;
using joint_scene::shared_state;
using joint_scene::tag_state;
using joint_scene::World;

constexpr SolverOptions kToTheEnd{.max_iterations = 60, .step_tolerance = 1e-13};

// Truth is the exact minimum: no noise, and every prior centred on it.
World make_exact_world() {
  World w = make_world(5, 24, 1.6);
  for (PortState& port : w.truth.ports) port.electrical_length_m = w.problem.priors.electrical_length_m[0];
  w.truth.ports[1].offset_rad = 0.0;  // its weak prior (20 rad) is centred on zero
  for (auto& reads : w.problem.reads)
    for (std::size_t i = 0; i < reads.size(); ++i) {
      JointRead& r = reads[i];
      const auto t = static_cast<std::size_t>(&reads - w.problem.reads.data());
      r.phase_rad = r.geometry.wavenumber_rad_m * (r.p_W_A - w.truth.tags[t].p_W_X).norm() +
                    w.truth.tags[t].offset_rad +
                    r.geometry.frequency_term_rad_m * w.problem.priors.electrical_length_m[0];
    }
  return w;
}

// Wrong by a part of the quarter wavelength (8 cm) that a phase leaves open; theta and the time offset, where the
// derivatives are exact, at zero.
JointState perturbed(const JointState& truth, std::mt19937& random, double tag_m) {
  JointState s = truth;
  s.log_scale += 0.006;
  s.ports[1].offset_rad += 0.15;
  for (PortState& port : s.ports) port.electrical_length_m += 0.3;
  for (TagState& tag : s.tags) {
    tag.p_W_X += random_vector(random, tag_m);
    tag.offset_rad += 0.1;
  }
  return s;
}

// Least squares in the open: every whitened row's derivatives by central differences, tags behind the shared states.
struct Dense {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  int shared = 0;
};

Dense dense_normal_equations(const World& w, const JointState& state) {
  const SharedLayout layout = layout_of(state);
  const int tags = static_cast<int>(state.tags.size());
  Dense d{Eigen::MatrixXd::Zero(layout.size() + 4 * tags, layout.size() + 4 * tags),
          Eigen::VectorXd::Zero(layout.size() + 4 * tags), layout.size()};
  WhitenedTag at, plus, minus;
  for (int t = 0; t < tags; ++t) {
    const auto& reads = w.problem.reads[static_cast<std::size_t>(t)];
    whiten(reads, w.problem, state, state.tags[static_cast<std::size_t>(t)], false, at);
    const auto rows = static_cast<Eigen::Index>(reads.size());
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, d.H.cols());
    Eigen::VectorXd r(rows), weight(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      r[i] = at.rows[static_cast<std::size_t>(i)].residual;
      weight[i] = at.rows[static_cast<std::size_t>(i)].weight;
    }
    for (int c = 0; c < d.shared + 4; ++c) {
      if (c == layout.port(0)) continue;
      constexpr double kStep = 1e-5;
      const auto shifted = [&](double h, WhitenedTag& out) {
        JointState s = state;
        TagState& tag = s.tags[static_cast<std::size_t>(t)];
        (c < d.shared ? shared_state(s, c) : tag_state(tag, c - d.shared)) += h;
        whiten(reads, w.problem, s, tag, false, out);
      };
      shifted(kStep, plus);
      shifted(-kStep, minus);
      const int column = c < d.shared ? c : d.shared + 4 * t + (c - d.shared);
      for (Eigen::Index i = 0; i < rows; ++i)
        J(i, column) =
            -(plus.rows[static_cast<std::size_t>(i)].residual - minus.rows[static_cast<std::size_t>(i)].residual) /
            (2.0 * kStep);
    }
    d.H += J.transpose() * weight.asDiagonal() * J;
    d.g += J.transpose() * weight.asDiagonal() * r;
    d.H.diagonal().segment<4>(d.shared + 4 * t).array() += 1.0 / 400.0;  // a tag is known to 20 m and 20 rad
  }
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(d.shared, d.shared);
  Eigen::VectorXd prior_g = Eigen::VectorXd::Zero(d.shared);
  (void)add_path_prior(w.problem, state, layout, &prior, &prior_g);
  d.H.topLeftCorner(d.shared, d.shared) += prior.selfadjointView<Eigen::Lower>().toDenseMatrix();
  d.g.head(d.shared) += prior_g;
  return d;
}

// |a - b| of an entry against the sigmas of its row and column.
double worst_relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::VectorXd& row_sigma,
                      const Eigen::VectorXd& column_sigma) {
  return ((a - b).array() / (row_sigma * column_sigma.transpose()).array()).abs().maxCoeff();
}

TEST(JointSolver, TruthIsAFixedPoint) {
  const World w = make_exact_world();
  JointState state = w.truth;
  const double cost = total_cost(w.problem, state);
  EXPECT_TRUE(solve(w.problem, kToTheEnd, state).converged);
  EXPECT_NEAR(total_cost(w.problem, state), cost, 1e-9);
  for (std::size_t t = 0; t < 5; ++t) EXPECT_NEAR((state.tags[t].p_W_X - w.truth.tags[t].p_W_X).norm(), 0.0, 1e-9);
}

TEST(JointSolver, FindsTheTruthFromWithinAQuarterWavelength) {
  const World w = make_exact_world();
  const double best = total_cost(w.problem, w.truth);
  for (unsigned seed = 51; seed < 56; ++seed) {
    std::mt19937 random(seed);
    JointState state = perturbed(w.truth, random, 0.02);
    const SolverReport report = solve(w.problem, kToTheEnd, state);
    EXPECT_TRUE(report.converged);
    EXPECT_NEAR(report.cost, best, 1e-6);
    EXPECT_NEAR(report.cost, total_cost(w.problem, state), 1e-9);
    EXPECT_NEAR(state.log_scale, w.truth.log_scale, 1e-4);
    for (std::size_t t = 0; t < 5; ++t)
      EXPECT_LT((state.tags[t].p_W_X - w.truth.tags[t].p_W_X).norm(), 1e-3) << seed << " " << t;
  }
}

TEST(JointSolver, CovarianceIsTheInverseOfTheWholeNormalMatrix) {
  const World w = make_exact_world();
  const Dense d = dense_normal_equations(w, w.truth);
  const Eigen::MatrixXd inverse = d.H.ldlt().solve(Eigen::MatrixXd::Identity(d.H.rows(), d.H.cols()));
  const Eigen::VectorXd sigma = inverse.diagonal().cwiseSqrt();
  const JointCovariance c = covariance(w.problem, w.truth);
  ASSERT_EQ(c.shared.rows(), d.shared);
  // The derivatives are good to 1e-5 in some 800 / rad (wavenumber over white noise): 1e-8 of the largest, and up to
  // 1e4 more where a direction is seen through small differences only.
  constexpr double kRelative = 1e-4;
  EXPECT_LT(
      worst_relative(c.shared, inverse.topLeftCorner(d.shared, d.shared), sigma.head(d.shared), sigma.head(d.shared)),
      kRelative);
  for (int t = 0; t < 5; ++t) {
    const int at = d.shared + 4 * t;
    EXPECT_LT(worst_relative(c.tag[static_cast<std::size_t>(t)], inverse.block<4, 4>(at, at), sigma.segment<4>(at),
                             sigma.segment<4>(at)),
              kRelative);
    EXPECT_LT(worst_relative(c.tag_shared[static_cast<std::size_t>(t)], inverse.block(at, 0, 4, d.shared),
                             sigma.segment<4>(at), sigma.head(d.shared)),
              kRelative);
  }
}

TEST(JointSolver, OneStepIsTheDampedStepOfTheWholeSystem) {
  const World w = make_exact_world();
  std::mt19937 random(52);
  const JointState start = perturbed(w.truth, random, 0.004);
  const Dense d = dense_normal_equations(w, start);
  Eigen::MatrixXd damped = d.H;
  damped.diagonal() *= 1.0 + 1e-4;  // the first lambda
  const Eigen::VectorXd step = damped.ldlt().solve(d.g);
  JointState state = start;
  ASSERT_EQ(solve(w.problem, {.max_iterations = 1}, state).iterations, 1);
  ASSERT_LT(total_cost(w.problem, state), total_cost(w.problem, start));
  const Eigen::VectorXd sigma =
      d.H.ldlt().solve(Eigen::MatrixXd::Identity(d.H.rows(), d.H.cols())).diagonal().cwiseSqrt();
  JointState s = state, from = start;
  // Errors of the numeric derivatives (see above), in sigmas of each state; the step itself is many sigmas long.
  for (int c = 0; c < d.shared; ++c)
    EXPECT_NEAR((shared_state(s, c) - shared_state(from, c)) / sigma[c], step[c] / sigma[c], 1e-3) << c;
  for (int t = 0; t < 5; ++t)
    for (int i = 0; i < 4; ++i) {
      const int c = d.shared + 4 * t + i;
      const double moved =
          tag_state(s.tags[static_cast<std::size_t>(t)], i) - tag_state(from.tags[static_cast<std::size_t>(t)], i);
      EXPECT_NEAR(moved / sigma[c], step[c] / sigma[c], 1e-3) << c;
    }
  EXPECT_GT((step.array() / sigma.array()).abs().maxCoeff(), 1.0);
}

TEST(JointSolver, TagCouplingIsTheSchurComplementOfItsOwnReads) {
  World w = make_exact_world();
  std::mt19937 random(53);
  JointState state = perturbed(w.truth, random, 0.004);
  w.problem.reads = {w.problem.reads[2]};
  state.tags = {state.tags[2]};
  Dense d = dense_normal_equations(w, state);
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(d.shared, d.shared);
  Eigen::VectorXd prior_g = Eigen::VectorXd::Zero(d.shared);
  (void)add_path_prior(w.problem, state, layout_of(state), &prior, &prior_g);
  d.H.topLeftCorner(d.shared, d.shared) -= prior.selfadjointView<Eigen::Lower>().toDenseMatrix();
  d.g.head(d.shared) -= prior_g;
  const Eigen::Matrix4d own = d.H.bottomRightCorner<4, 4>().inverse();
  const Eigen::MatrixXd cross = d.H.bottomLeftCorner(4, d.shared);
  const Eigen::MatrixXd information = d.H.topLeftCorner(d.shared, d.shared) - cross.transpose() * own * cross;
  const Eigen::VectorXd gradient = d.g.head(d.shared) - cross.transpose() * own * d.g.tail<4>();
  const TagCoupling c = tag_coupling(w.problem, state);
  EXPECT_LT((c.own_covariance - own).norm(), 1e-4 * own.norm());
  EXPECT_LT((c.H_shared - cross).norm(), 1e-5 * cross.norm());
  EXPECT_LT((c.information - information).norm(), 1e-4 * information.norm());
  EXPECT_LT((c.gradient - gradient).norm(), 1e-4 * gradient.norm() + 1e-3);
  EXPECT_NEAR((c.information - c.information.transpose()).norm(), 0.0, 1e-9 * information.norm());
}

TEST(JointSolver, WithSharedStatesFixedOnlyTagsMove) {
  const World w = make_exact_world();
  std::mt19937 random(54);
  JointState start = w.truth;
  for (TagState& tag : start.tags) tag.p_W_X += random_vector(random, 0.015);
  start.knots[2].path_correction_W.x() = 1e-4;
  JointState state = start;
  SolverOptions options = kToTheEnd;
  options.shared_fixed = true;
  (void)solve(w.problem, options, state);
  for (int c = 0; c < layout_of(state).size(); ++c) EXPECT_EQ(shared_state(state, c), shared_state(start, c)) << c;
  for (std::size_t t = 0; t < 5; ++t) {
    EXPECT_NE(state.tags[t].p_W_X, start.tags[t].p_W_X);
    // 0.1 mm of path error at one knot, seen from two sides: at most a few times that.
    EXPECT_LT((state.tags[t].p_W_X - w.truth.tags[t].p_W_X).norm(), 1e-3);
  }
}

TEST(JointSolver, TheOrderOfTagsDoesNotMatter) {
  World w = make_exact_world();
  std::mt19937 random(55);
  std::normal_distribution<double> normal(0.0, 0.05);
  for (auto& reads : w.problem.reads)
    for (JointRead& r : reads) r.phase_rad += normal(random);
  JointState state = perturbed(w.truth, random, 0.01), reversed = state;
  World other = w;
  std::reverse(other.problem.reads.begin(), other.problem.reads.end());
  std::reverse(reversed.tags.begin(), reversed.tags.end());
  const double cost = solve(w.problem, kToTheEnd, state).cost;
  EXPECT_NEAR(solve(other.problem, kToTheEnd, reversed).cost, cost, 1e-8);
  // Both stop where 1e-13 of the cost is left: 1e-5 sigmas, and a sigma is some centimetres.
  EXPECT_NEAR(reversed.log_scale, state.log_scale, 1e-6);
  for (std::size_t t = 0; t < 5; ++t) EXPECT_NEAR((reversed.tags[4 - t].p_W_X - state.tags[t].p_W_X).norm(), 0.0, 1e-6);
}

TEST(JointSolver, AConstantInAllPhasesOfATagOnlyChangesItsOffset) {
  World w = make_exact_world();
  std::mt19937 random(56);
  std::normal_distribution<double> normal(0.0, 0.05);
  for (auto& reads : w.problem.reads)
    for (JointRead& r : reads) r.phase_rad += normal(random);
  JointState state = w.truth, shifted = w.truth;
  (void)solve(w.problem, kToTheEnd, state);
  for (JointRead& r : w.problem.reads[1]) r.phase_rad += 0.4;
  (void)solve(w.problem, kToTheEnd, shifted);
  EXPECT_NEAR(shifted.log_scale, state.log_scale, 1e-6);
  for (std::size_t t = 0; t < 5; ++t) {
    EXPECT_NEAR((shifted.tags[t].p_W_X - state.tags[t].p_W_X).norm(), 0.0, 1e-6);
    EXPECT_NEAR(shifted.tags[t].offset_rad - state.tags[t].offset_rad, t == 1 ? 0.4 : 0.0, 1e-5);
  }
}

TEST(JointSolver, NeverRaisesTheCost) {
  World w = make_exact_world();
  std::mt19937 random(57);
  std::normal_distribution<double> normal(0.0, 0.3);
  w.problem.flip_probability = 0.003;
  w.problem.outlier_probability = 0.01;
  for (auto& reads : w.problem.reads)
    for (JointRead& r : reads) r.phase_rad += normal(random);
  JointState state = perturbed(w.truth, random, 0.1);
  double before = total_cost(w.problem, state);
  for (int i = 0; i < 15; ++i) {
    const SolverReport report = solve(w.problem, {.max_iterations = 1}, state);
    EXPECT_LE(report.cost, before);
    before = report.cost;
  }
}

TEST(JointSolver, ErrorsAreAsLargeAsTheCovarianceSays) {
  // Shared states known; white noise and no structured error: 60 runs of 5 tags, each (position, offset)'s normalised
  // square is chi-square with 4 degrees of freedom: mean 4, of the mean sigma sqrt(8 / 300) = 0.16. Linearisation and
  // the tags' common path leave some room: five sigmas.
  World w = make_exact_world();
  for (TagState& tag : w.truth.tags) tag.structured_sigma_rad = 1e-4;
  std::mt19937 random(58);
  std::normal_distribution<double> normal(0.0, 0.05);
  double sum = 0.0;
  constexpr int kRuns = 60;
  for (int run = 0; run < kRuns; ++run) {
    World noisy = w;
    for (auto& reads : noisy.problem.reads)
      for (JointRead& r : reads) r.phase_rad += normal(random);
    for (std::size_t t = 0; t < 5; ++t) {
      World one = noisy;
      one.problem.reads = {noisy.problem.reads[t]};
      JointState state = w.truth;
      state.tags = {w.truth.tags[t]};
      (void)solve(one.problem, {.max_iterations = 20, .step_tolerance = 1e-10, .shared_fixed = true}, state);
      Eigen::Vector4d error;
      error << state.tags[0].p_W_X - w.truth.tags[t].p_W_X, state.tags[0].offset_rad - w.truth.tags[t].offset_rad;
      sum += error.dot(tag_coupling(one.problem, state).own_covariance.inverse() * error) / (5.0 * kRuns);
    }
  }
  EXPECT_NEAR(sum, 4.0, 0.8);
}

}  // namespace
}  // namespace rfmvo
