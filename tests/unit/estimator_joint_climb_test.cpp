#include <gtest/gtest.h>

#include "estimator/path_prior.hpp"
#include "estimator/tag_climb.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::layout_of;
using joint_scene::make_world;
using joint_scene::World;

TEST(TagLikelihood, ClimbsToTheTagFromNearby) {
  const World w = make_world(3, 30, 1.6);
  for (std::size_t t = 0; t < 3; ++t) {
    TagLikelihood likelihood(w.problem.reads[t], w.problem, w.truth, 0.2);
    const Eigen::Vector3d tag = w.truth.tags[t].p_W_X;
    const auto top = likelihood.climb(tag + Eigen::Vector3d(0.02, -0.03, 0.02));
    EXPECT_LT((top.p_W_X - tag).norm(), 1e-3) << t;  // phases are exact; the climb ends within its tolerance
  }
}

TEST(TagLikelihood, IsTheSolversCostLessThePrior) {
  std::mt19937 random(71);
  World w = make_world(1, 25, 0.8);
  std::normal_distribution<double> noise(0.0, 0.3);
  for (JointRead& read : w.problem.reads[0]) read.phase_rad += noise(random);
  TagLikelihood likelihood(w.problem.reads[0], w.problem, w.truth, w.truth.tags[0].structured_sigma_rad);
  const auto top = likelihood.climb(w.truth.tags[0].p_W_X);
  JointState state = w.truth;
  state.tags[0].p_W_X = top.p_W_X;
  state.tags[0].offset_rad = top.offset_rad;
  const double prior = add_path_prior(w.problem, state, layout_of(state), nullptr, nullptr);
  EXPECT_NEAR(top.cost, total_cost(w.problem, state) - prior, 1e-9 * std::abs(top.cost));
}

TEST(TagLikelihood, CovarianceIsThatOfTheSolverWithTheSharedStatesFixed) {
  const World w = make_world(1, 30, 1.6);
  TagLikelihood likelihood(w.problem.reads[0], w.problem, w.truth, w.truth.tags[0].structured_sigma_rad);
  const auto top = likelihood.climb(w.truth.tags[0].p_W_X);
  const TagCoupling coupling = tag_coupling(w.problem, w.truth);
  // Each has a weak prior of its own on the tag, of 20 m and less.
  EXPECT_LT((top.covariance - coupling.own_covariance).norm(), 0.02 * coupling.own_covariance.norm());
}

TEST(TagLikelihood, CountsTheReadsWithinReach) {
  const World w = make_world(1, 20, 1.0);
  const TagLikelihood likelihood(w.problem.reads[0], w.problem, w.truth, 0.2);
  EXPECT_EQ(likelihood.share_within(100.0, w.truth.tags[0].p_W_X), 1.0);
  EXPECT_EQ(likelihood.share_within(1.0, Eigen::Vector3d(50.0, 0.0, 0.0)), 0.0);
}

}  // namespace
}  // namespace rfmvo
