#include <gtest/gtest.h>

#include "evaluate/alignment.hpp"
#include "support/evaluate_world.hpp"

namespace rfmvo::evaluate {
namespace {

using namespace rfmvo::testing;  // NOLINT(google-build-using-namespace)

std::vector<PosePair> pairs_of(const simulate::Truth& truth, const Rigid3& T, double scale) {
  std::vector<PosePair> pairs;
  for (const auto& pose : truth.trajectory) {
    Rigid3 estimated = T * pose.T_W_C;
    estimated.t *= scale;
    pairs.push_back({estimated, pose.T_W_C});
  }
  return pairs;
}

TEST(Alignment, FindsTheMotionAndTheScaleItWasMadeWith) {
  const auto truth = winding_truth(50, 0);
  const auto found = align(pairs_of(truth, some_motion(), 2.5), {.with_scale = true});
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->scale, 1.0 / 2.5, 1e-12);
  const Rigid3 expected = some_motion().inverse();
  EXPECT_LT((found->T.t - expected.t).norm(), 1e-9);
  EXPECT_LT(found->T.R.angularDistance(expected.R), 1e-9);
}

TEST(Alignment, OrientationsFixTheRollAboutAStraightPath) {
  const auto truth = winding_truth(50, 0, 0.0);
  const auto found = align(pairs_of(truth, some_motion(), 1.0), {.orientation_weight_m2 = 1.0});
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(found->T.R.angularDistance(some_motion().inverse().R), 1e-7);  // a Quaterniond angle: sqrt of rounding
}

TEST(Alignment, NeverReflects) {
  auto pairs = pairs_of(winding_truth(50, 0), {}, 1.0);
  for (PosePair& pair : pairs) pair.estimated.t.z() *= -1.0;
  const auto found = align(pairs, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->T.R.toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(Alignment, NeedsThreePosesAndMotion) {
  const auto truth = winding_truth(2, 0);
  EXPECT_FALSE(align(pairs_of(truth, {}, 1.0), {}).has_value());
  EXPECT_FALSE(align(std::vector<PosePair>(10), {.with_scale = true}).has_value());
}

TEST(TruthAt, InterpolatesBetweenPosesAndNowhereElse) {
  auto truth = winding_truth(10, 0);
  const auto& path = truth.trajectory;
  const auto middle = truth_at(path, frame_time(3) + Duration{kFrame_ns / 2});
  ASSERT_TRUE(middle.has_value());
  EXPECT_LT((middle->t - 0.5 * (path[3].T_W_C.t + path[4].T_W_C.t)).norm(), 1e-12);
  EXPECT_TRUE(truth_at(path, path.front().time - kTimeSlack).has_value());
  EXPECT_FALSE(truth_at(path, path.front().time - kTimeSlack - Duration{1}).has_value());
  EXPECT_TRUE(truth_at(path, path.back().time + kTimeSlack).has_value());
  EXPECT_FALSE(truth_at(path, path.back().time + kTimeSlack + Duration{1}).has_value());
  EXPECT_FALSE(truth_at({}, frame_time(0)).has_value());
}

TEST(TruthAt, DoesNotBridgeALongGap) {
  auto path = winding_truth(100, 0).trajectory;
  path.erase(path.begin() + 10, path.begin() + 60);
  EXPECT_FALSE(truth_at(path, frame_time(30)).has_value());
  EXPECT_TRUE(truth_at(path, frame_time(60)).has_value());
}

}  // namespace
}  // namespace rfmvo::evaluate
