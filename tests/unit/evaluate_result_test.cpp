#include <gtest/gtest.h>

#include "evaluate/evaluation.hpp"
#include "support/evaluate_world.hpp"

namespace rfmvo::evaluate {
namespace {

using namespace rfmvo::testing;  // NOLINT(google-build-using-namespace)

// Positions are metres of order 10, residuals of rounding some 1e-15 of that.
constexpr double kRounding = 1e-9;

Evaluation evaluated(const std::vector<Estimate>& result, const simulate::Truth& truth) {
  auto evaluation = evaluate(result, truth);
  EXPECT_TRUE(evaluation.ok()) << (evaluation ? "" : evaluation.error().text());
  return std::move(evaluation).value();
}

template <class T>
std::vector<Estimate> without(std::vector<Estimate> result) {
  std::erase_if(result, [](const Estimate& e) { return std::holds_alternative<T>(e); });
  return result;
}

TEST(Evaluate, PerfectResultInAnotherWorldHasNoError) {
  const auto truth = winding_truth(400, 20);
  const Evaluation e = evaluated(perfect_result(truth, {.T_W_truth = some_motion()}), truth);
  EXPECT_EQ(e.tags.located, 20);
  EXPECT_EQ(e.tags.total, 20);
  EXPECT_LT(e.tags.error_m->max, kRounding);
  EXPECT_LT(e.tags.camera_relative_m->max, kRounding);
  EXPECT_LT(*e.trajectory.ate_se3_m, kRounding);
  EXPECT_LT(*e.scale.relative_error, kRounding);
  EXPECT_LT(*e.scale.eq31, kRounding);
  EXPECT_NEAR(*e.scale.true_m_per_unit, kMetresPerUnit, kRounding);
  EXPECT_EQ(e.tags.coverage95, 1.0);
  EXPECT_EQ(e.tags.coverage95_world, 1.0);
}

TEST(Evaluate, ACommonRigidMotionOfTheTruthChangesNothing) {
  const auto truth = winding_truth(400, 20);
  const auto result = noisy_result(truth);
  const Evaluation a = evaluated(result, truth);
  const Evaluation b = evaluated(result, moved(truth, some_motion()));
  ASSERT_GT(a.tags.error_m->mean, 0.02);
  EXPECT_NEAR(a.tags.error_m->mean, b.tags.error_m->mean, kRounding);
  EXPECT_NEAR(a.tags.camera_relative_m->mean, b.tags.camera_relative_m->mean, kRounding);
  EXPECT_NEAR(*a.trajectory.ate_se3_m, *b.trajectory.ate_se3_m, kRounding);
  EXPECT_NEAR(*a.trajectory.ate_sim3_m, *b.trajectory.ate_sim3_m, kRounding);
  EXPECT_NEAR(*a.scale.relative_error, *b.scale.relative_error, kRounding);
  EXPECT_NEAR(*a.tags.nees_mean, *b.tags.nees_mean, 1e-6);
  EXPECT_NEAR(*a.tags.nees_world_mean, *b.tags.nees_world_mean, 1e-6);
}

TEST(Evaluate, ACommonRigidMotionOfTheTruthChangesNothingOnAStraightPath) {
  const auto truth = winding_truth(400, 20, 0.01);
  const auto result = noisy_result(truth);
  const Evaluation a = evaluated(result, truth);
  const Evaluation b = evaluated(result, moved(truth, some_motion()));
  ASSERT_TRUE(a.trajectory.segments.at(0).aligned_with_orientations);
  EXPECT_NEAR(a.tags.error_m->mean, b.tags.error_m->mean, kRounding);
}

TEST(Evaluate, StraightPathDoesNotTurnTheTagsAboutIt) {
  const auto truth = winding_truth(400, 20, 0.0);
  const Evaluation e = evaluated(noisy_result(truth), truth);
  // 5 cm per axis: mean length 5 * sqrt(8 / pi) = 8 cm; a wrong roll would cost the metre to the tags.
  EXPECT_LT(e.tags.error_m->mean, 0.10);
}

TEST(Evaluate, ScalingThePathByTwoPerCentIsFound) {
  const auto truth = winding_truth(400, 20);
  const Evaluation e = evaluated(perfect_result(truth, {.T_W_truth = some_motion(), .metric_error = 1.02}), truth);
  // evo's factor goes from the estimate to the truth.
  EXPECT_NEAR(*e.scale.relative_error, 1.0 - 1.0 / 1.02, kRounding);
  EXPECT_NEAR(*e.scale.relative_error, 0.02, 0.0005);
  EXPECT_NEAR(*e.scale.eq31, 0.02 * kMetresPerUnit, kRounding);
  EXPECT_NEAR(*e.scale.eq31_relative, 0.02, kRounding);
  EXPECT_LT(*e.trajectory.ate_sim3_m, kRounding);
  EXPECT_GT(*e.trajectory.ate_se3_m, 0.01);
}

TEST(Evaluate, ShiftingOneTagShiftsItsErrorOnly) {
  const auto truth = winding_truth(400, 4);
  auto result = perfect_result(truth);
  const Eigen::Vector3d shift(0.03, 0.04, 0.12);
  auto& tag = std::get<TagEstimate>(result.back());
  tag.p_W_X_m += shift;
  tag.p_C_X_m += 2.0 * shift;
  const Evaluation e = evaluated(result, truth);
  EXPECT_NEAR(*e.tags.tags[3].error_m, 0.13, kRounding);
  EXPECT_NEAR(*e.tags.tags[3].camera_relative_error_m, 0.26, kRounding);
  EXPECT_NEAR(e.tags.error_m->mean, 0.13 / 4, kRounding);
  EXPECT_NEAR(e.tags.error_m->rmse, 0.13 / 2, kRounding);
  EXPECT_NEAR(e.tags.error_m->median, 0.0, kRounding);
  EXPECT_EQ(e.tags.coverage95, 0.75);
}

TEST(Evaluate, CoverageOfExactlySampledErrorsIsNinetyFivePerCent) {
  constexpr int kTags = 4000;
  const auto truth = winding_truth(400, kTags);
  const Perfect how{.T_W_truth = some_motion()};
  auto result = perfect_result(truth, how);
  std::mt19937_64 random(11);
  Eigen::Matrix3d covariance;
  covariance << 4e-4, 3e-4, 0, 3e-4, 9e-4, -1e-4, 0, -1e-4, 100e-4;
  for (Estimate& estimate : result) {
    auto* tag = std::get_if<TagEstimate>(&estimate);
    if (tag == nullptr) continue;
    tag->covariance_m2 = tag->covariance_C_m2 = covariance;
    tag->p_W_X_m += sample(covariance, random);
    tag->p_C_X_m += sample(covariance, random);
  }
  const Evaluation e = evaluated(result, truth);
  // Four standard deviations of a binomial share, and of the mean of chi-square(3), variance 6.
  const double share_tolerance = 4.0 * std::sqrt(0.95 * 0.05 / kTags), nees_tolerance = 4.0 * std::sqrt(6.0 / kTags);
  EXPECT_NEAR(*e.tags.coverage95, 0.95, share_tolerance);
  EXPECT_NEAR(*e.tags.coverage95_world, 0.95, share_tolerance);
  EXPECT_NEAR(*e.tags.nees_mean, 3.0, nees_tolerance);
  EXPECT_NEAR(*e.tags.nees_world_mean, 3.0, nees_tolerance);
}

TEST(Evaluate, OnlyTheLastEstimateOfATagCounts) {
  const auto truth = winding_truth(400, 1);
  auto result = perfect_result(truth);
  auto wrong = std::get<TagEstimate>(result.back());
  wrong.p_W_X_m.x() += 1.0;
  result.insert(result.begin(), wrong);
  EXPECT_LT(evaluated(result, truth).tags.error_m->max, kRounding);
}

TEST(Evaluate, TagsWithoutAPositionAreNotLocated) {
  const auto truth = winding_truth(400, 5);
  auto result = perfect_result(truth);
  const std::size_t first = result.size() - 5;
  std::get<TagEstimate>(result[first]).status = TagStatus::kTooFewReads;
  std::get<TagEstimate>(result[first + 1]).status = TagStatus::kNoScale;
  std::get<TagEstimate>(result[first + 2]).p_W_X_m.y() = std::nan("");
  std::get<TagEstimate>(result[first + 3]).status = TagStatus::kMirror;
  const Evaluation e = evaluated(result, truth);
  EXPECT_EQ(e.tags.located, 2);
  EXPECT_EQ(e.tags.total, 5);
  EXPECT_FALSE(e.tags.tags[0].error_m.has_value());
  EXPECT_TRUE(e.tags.tags[3].error_m.has_value());
}

TEST(Evaluate, TagsThatTheTruthDoesNotKnowAreListedApart) {
  const auto truth = winding_truth(400, 5);
  const auto result = perfect_result(truth);
  auto smaller = truth;
  smaller.tags.pop_back();
  const Evaluation e = evaluated(result, smaller);
  EXPECT_EQ(e.tags.located, 4);
  ASSERT_EQ(e.tags.unknown.size(), 1u);
  EXPECT_EQ(e.tags.unknown[0], epc_of(4));
}

TEST(Evaluate, CertaintyWithoutCovarianceCountsAsOutside) {
  const auto truth = winding_truth(400, 1);
  auto result = perfect_result(truth);
  std::get<TagEstimate>(result.back()).covariance_C_m2.setZero();
  const Evaluation e = evaluated(result, truth);
  EXPECT_EQ(e.tags.coverage95, 0.0);
  EXPECT_FALSE(e.tags.nees_mean.has_value());
}

TEST(Evaluate, ResultThatSaysNothingIsNoError) {
  const auto truth = winding_truth(400, 5);
  const Evaluation e = evaluated({}, truth);
  EXPECT_EQ(e.tags.located, 0);
  EXPECT_EQ(e.tags.total, 5);
  EXPECT_FALSE(e.tags.error_m || e.tags.coverage95 || e.trajectory.ate_se3_m || e.scale.relative_error || e.scale.eq31);
  EXPECT_GT(e.trajectory.path_m, 8.0);
}

TEST(Evaluate, WithoutAPathTheCameraRelativeErrorRemains) {
  const auto truth = winding_truth(400, 5);
  const Evaluation e = evaluated(without<Trajectory>(perfect_result(truth)), truth);
  EXPECT_FALSE(e.tags.error_m.has_value());
  EXPECT_LT(e.tags.camera_relative_m->max, kRounding);
  EXPECT_LT(*e.scale.eq31, kRounding);
}

TEST(Evaluate, PathAtAnotherTimeIsAnError) {
  const auto truth = winding_truth(400, 5);
  auto later = truth;
  for (auto& pose : later.trajectory) pose.time = pose.time + Duration::from_seconds(1000);
  const auto evaluation = evaluate(perfect_result(truth), later);
  ASSERT_FALSE(evaluation.ok());
  EXPECT_NE(evaluation.error().text().find("no time in common"), std::string::npos);
}

TEST(Evaluate, SegmentsAreAlignedEachByItself) {
  const auto truth = winding_truth(400, 6);
  auto result = without<Trajectory>(perfect_result(truth));
  const Rigid3 worlds[] = {Rigid3{}, some_motion()};
  for (std::uint32_t segment = 0; segment < 2; ++segment) {
    Trajectory part = perfect_trajectory(truth, {.T_W_truth = worlds[segment]});
    part.segment = segment;
    if (segment == 0)
      part.poses.resize(200);
    else
      part.poses.erase(part.poses.begin(), part.poses.begin() + 200);
    result.emplace_back(part);
  }
  auto& tag = std::get<TagEstimate>(result[result.size() - 3]);
  tag.segment = 1;
  tag.p_W_X_m = some_motion() * truth.tags.back().p_W_X_m;
  const Evaluation e = evaluated(result, truth);
  EXPECT_EQ(e.trajectory.segments.size(), 2u);
  EXPECT_LT(*e.trajectory.ate_se3_m, kRounding);
  EXPECT_LT(e.tags.error_m->max, kRounding);
}

TEST(Evaluate, BestHypothesisIsReportedBesideTheHeaviest) {
  const auto truth = winding_truth(400, 1);
  auto result = perfect_result(truth);
  auto& tag = std::get<TagEstimate>(result.back());
  TagHypothesis right;
  right.p_W_X_m = tag.p_W_X_m;
  tag.p_W_X_m.z() += 0.5;
  tag.hypotheses = {TagHypothesis{tag.p_W_X_m, tag.covariance_m2, 0.6}, right};
  const Evaluation e = evaluated(result, truth);
  EXPECT_NEAR(*e.tags.tags[0].error_m, 0.5, kRounding);
  EXPECT_NEAR(*e.tags.tags[0].best_hypothesis_error_m, 0.0, kRounding);
}

TEST(Evaluate, Equation31LeavesOutLostPosesAndStandingStill) {
  auto truth = winding_truth(400, 0);
  for (int i = 0; i < 50; ++i) {
    truth.trajectory.push_back({frame_time(400 + i), truth.trajectory.back().T_W_C});
  }
  auto result = perfect_result(truth);
  auto& pose = std::get<CameraPose>(result[10]);
  pose.status = VoStatus::kLost;
  pose.T_V_C.p_V_C.setConstant(1e6);
  std::get<CameraPose>(result[420]).T_V_C.p_V_C.x() += 1e-3;
  const Evaluation e = evaluated(result, truth);
  EXPECT_EQ(e.scale.eq31_steps, 399 - 2);
  EXPECT_LT(*e.scale.eq31, kRounding);
}

}  // namespace
}  // namespace rfmvo::evaluate
