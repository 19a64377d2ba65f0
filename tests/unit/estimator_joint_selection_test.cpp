#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "estimator/mode_selection.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::make_world;
using joint_scene::World;

struct Solved {
  World world;
  JointState state;
  JointCovariance covariance;
};

Solved solved_world(int tags) {
  Solved s{make_world(tags, 25, 1.4), {}, {}};
  s.state = s.world.truth;
  (void)solve(s.world.problem, {.max_iterations = 10}, s.state);
  s.covariance = covariance(s.world.problem, s.state);
  return s;
}

OtherReads without(const Eigen::MatrixXd& information, const TagCoupling* own) {
  OtherReads others{information, Eigen::VectorXd::Zero(information.rows())};
  if (own != nullptr) take_out(*own, 1.0, others);
  return others;
}

JointProblem alone(const JointProblem& problem, std::size_t t) {
  JointProblem one = problem;
  one.reads = {problem.reads[t]};
  return one;
}

TEST(ModeSelection, CovarianceOfAJoinedTagsOwnModeIsThatOfTheJointSolution) {
  const Solved s = solved_world(4);
  for (std::size_t t = 0; t < 4; ++t) {
    const JointProblem one = alone(s.world.problem, t);
    JointState state = s.state;
    state.tags = {s.state.tags[t]};
    const TagCoupling own = tag_coupling(one, state);
    std::vector<TagMode> modes(1);
    modes[0].tag = s.state.tags[t];
    select_modes(one, state, without(s.covariance.information, &own), modes);
    // Taken out of the solution and put back: the same matrices in another order.
    EXPECT_LT((modes[0].covariance - s.covariance.tag[t]).norm(), 1e-4 * s.covariance.tag[t].norm()) << t;
    EXPECT_DOUBLE_EQ(modes[0].weight, 1.0);
  }
}

TEST(ModeSelection, PrefersTheTruePlaceToOneThatOnlyABentPathWouldExplain) {
  const Solved s = solved_world(4);
  const JointProblem one = alone(s.world.problem, 0);
  JointState state = s.state;
  state.tags = {s.state.tags[0]};
  const TagCoupling own = tag_coupling(one, state);
  std::vector<TagMode> modes(2);
  for (std::size_t m = 0; m < 2; ++m) {
    modes[m].tag = s.state.tags[0];
    if (m == 0) modes[m].tag.p_W_X += Eigen::Vector3d(0.0, 0.05, 0.1);
    JointState at = state;
    at.tags = {modes[m].tag};
    modes[m].cost = total_cost(one, at) - total_cost(one, state);
  }
  select_modes(one, state, without(s.covariance.information, &own), modes);
  EXPECT_EQ(modes[0].tag.p_W_X, s.state.tags[0].p_W_X);
  EXPECT_GT(modes[0].weight, 0.99);
}

TEST(ModeSelection, SignalStrengthDecidesBetweenPlacesThatThePhasesCannotTellApart) {
  const Solved s = solved_world(2);
  const JointProblem one = alone(s.world.problem, 0);
  JointState state = s.state;
  state.tags = {s.state.tags[0]};
  std::vector<TagMode> modes(2);
  modes[0].tag = modes[1].tag = s.state.tags[0];
  modes[0].signal_cost = 2.0;
  modes[1].signal_cost = 1.0;
  select_modes(one, state, without(s.covariance.information, nullptr), modes);
  EXPECT_EQ(modes[0].signal_cost, 1.0);
  EXPECT_NEAR(modes[1].weight / modes[0].weight, std::exp(-1.0), 1e-9);
}

TEST(LogMarginalLikelihood, OfReadsThatTellNothingDoesNotDependOnHowStronglyTheOdometryDrifts) {
  World w = make_world(1, 6, 1.2);
  for (JointRead& read : w.problem.reads[0]) read.white_rad2 = 1e8;
  const double before = log_marginal_likelihood(w.problem, w.truth);
  w.problem.priors.scale_walk_per_sqrt_m *= 3.0;
  w.problem.priors.rotation_walk_rad_per_sqrt_m *= 2.0;
  w.problem.priors.position_walk_m_per_sqrt_m *= 5.0;
  EXPECT_NEAR(log_marginal_likelihood(w.problem, w.truth), before, 1e-6 * std::abs(before));
}

TEST(LogMarginalLikelihood, OfExactPhasesFavoursLessDrift) {
  World w = make_world(4, 25, 1.2);
  const double before = log_marginal_likelihood(w.problem, w.truth);
  w.problem.priors.scale_walk_per_sqrt_m *= 8.0;
  w.problem.priors.rotation_walk_rad_per_sqrt_m *= 4.0;
  w.problem.priors.position_walk_m_per_sqrt_m *= 8.0;
  EXPECT_LT(log_marginal_likelihood(w.problem, w.truth), before);
}

}  // namespace
// Each tag of `problem` twice, the copies counting a and 1 - a.
JointProblem split(const JointProblem& problem, double a) {
  JointProblem twice = problem;
  twice.reads.clear();
  for (const auto& reads : problem.reads)
    for (const double share : {a, 1.0 - a}) {
      twice.reads.push_back(reads);
      twice.share.push_back(share);
    }
  return twice;
}
JointState split(const JointState& state) {
  JointState twice = state;
  twice.tags.clear();
  for (const TagState& tag : state.tags) twice.tags.insert(twice.tags.end(), {tag, tag});
  return twice;
}

TEST(Shares, TwoCopiesOfATagAreWorthOne) {
  const Solved s = solved_world(3);
  const JointCovariance twice = covariance(split(s.world.problem, 0.3), split(s.state));
  EXPECT_LT((twice.information - s.covariance.information).norm(), 1e-9 * s.covariance.information.norm());
  for (std::size_t t = 0; t < 3; ++t)
    EXPECT_LT((twice.tag[2 * t] - s.covariance.tag[t]).norm(), 1e-6 * s.covariance.tag[t].norm()) << t;
  EXPECT_NEAR(total_cost(split(s.world.problem, 0.3), split(s.state)), total_cost(s.world.problem, s.state), 1e-9);
}

TEST(Shares, ALikelihoodOverTwoPlacesAsGoodIsThatOfOneAndTheirEntropy) {
  const Solved s = solved_world(3);
  const double one = log_marginal_likelihood(s.world.problem, s.state);
  for (const double a : {0.5, 0.1}) {
    const double entropy = -a * std::log(a) - (1.0 - a) * std::log(1.0 - a);
    EXPECT_NEAR(log_marginal_likelihood(split(s.world.problem, a), split(s.state)), one + 3.0 * entropy, 1e-6) << a;
  }
}

TEST(MissingInformation, WidensTheCovarianceAndNeverTakesMoreThanThereIs) {
  const Solved s = solved_world(4);
  const auto size = s.covariance.information.rows();
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Eigen::VectorXd pull(size);
  for (Eigen::Index i = 0; i < size; ++i)
    pull[i] = normal(random) * std::sqrt(s.covariance.information(i, i));
  for (const double strength : {1e-3, 1.0, 1e3}) {
    const Eigen::MatrixXd missing = strength * pull * pull.transpose();
    const JointCovariance less = covariance(s.world.problem, s.state, missing);
    const Eigen::MatrixXd wider = less.shared - s.covariance.shared;
    const double scale = s.covariance.shared.norm();
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(wider).eigenvalues()[0], -1e-6 * scale) << strength;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(less.shared).eigenvalues()[0], 0.0) << strength;
    EXPECT_EQ(less.information, s.covariance.information);
  }
}

}  // namespace rfmvo
