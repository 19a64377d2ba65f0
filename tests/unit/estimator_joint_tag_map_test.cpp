// What is kept of tags when a window is closed.
#include <gtest/gtest.h>

#include "estimator/tag_map.hpp"

namespace rfmvo {
namespace {

constexpr double kStaleAfter_s = 100.0;
const Epc kTag = Epc::from_hex("300833B2DDD9014000000001").value();

DeviceTime at(double seconds) { return {std::llround(seconds * 1e9)}; }

TagEstimate estimate(const Eigen::Vector3d& p_W, double sigma_m, double seconds,
                     TagStatus status = TagStatus::kConverged) {
  TagEstimate e;
  e.time = at(seconds);
  e.epc = kTag;
  e.status = status;
  e.p_W_X_m = p_W;
  e.covariance_m2 = e.covariance_C_m2 = sigma_m * sigma_m * Eigen::Matrix3d::Identity();
  return e;
}

TEST(TagMap, MoreCertainOfTwoAgreeingAnswersHolds) {
  TagMap map(kStaleAfter_s);
  map.keep(estimate({1.0, 0.0, 0.0}, 0.05, 10.0), at(10.0));
  const TagEstimate worse = estimate({1.1, 0.0, 0.0}, 0.10, 20.0), better = estimate({1.05, 0.0, 0.0}, 0.02, 20.0);
  EXPECT_EQ(map.best(kTag, &worse, at(20.0)).p_W_X_m.x(), 1.0);
  EXPECT_EQ(map.best(kTag, &better, at(20.0)).p_W_X_m.x(), 1.05);
  EXPECT_EQ(map.best(kTag, &better, at(20.0)).status, TagStatus::kConverged);
}

TEST(TagMap, NoPositionNeverReplacesOne) {
  TagMap map(kStaleAfter_s);
  map.keep(estimate({1.0, 0.0, 0.0}, 0.05, 10.0), at(10.0));
  for (const TagStatus nothing : {TagStatus::kTooFewReads, TagStatus::kNoScale}) {
    map.keep(estimate(Eigen::Vector3d::Zero(), 0.0, 20.0, nothing), at(20.0));
    EXPECT_EQ(map.best(kTag, nullptr, at(20.0)).p_W_X_m.x(), 1.0);
  }
}

TEST(TagMap, TagThatIsSurelyElsewhereWasMovedAndIsSettledOnceConfirmed) {
  TagMap map(kStaleAfter_s);
  map.keep(estimate({1.0, 0.0, 0.0}, 0.02, 10.0), at(10.0));
  map.keep(estimate({2.0, 0.0, 0.0}, 0.05, 20.0), at(20.0));
  EXPECT_EQ(map.best(kTag, nullptr, at(20.0)).status, TagStatus::kMoved);
  EXPECT_EQ(map.best(kTag, nullptr, at(20.0)).p_W_X_m.x(), 2.0);  // the newer one, though less certain
  const TagEstimate again = estimate({2.05, 0.0, 0.0}, 0.08, 30.0);
  EXPECT_EQ(map.best(kTag, &again, at(30.0)).status, TagStatus::kConverged);
}

TEST(TagMap, DoubtIsNoMove) {
  const TagEstimate held = estimate({1.0, 0.0, 0.0}, 0.05, 10.0);
  EXPECT_FALSE(contradict(held, estimate({2.0, 0.0, 0.0}, 0.05, 20.0, TagStatus::kMirror)));
  EXPECT_FALSE(contradict(held, estimate({2.0, 0.0, 0.0}, 0.30, 20.0)));   // within its own sigma
  EXPECT_FALSE(contradict(held, estimate({1.15, 0.0, 0.0}, 0.01, 20.0)));  // nearer than half a wavelength
  EXPECT_TRUE(contradict(held, estimate({2.0, 0.0, 0.0}, 0.05, 20.0)));
}

TEST(TagMap, TagNotReadForLongIsStale) {
  TagMap map(kStaleAfter_s);
  map.keep(estimate({1.0, 0.0, 0.0}, 0.05, 10.0), at(5.0));
  EXPECT_EQ(map.best(kTag, nullptr, at(5.0 + kStaleAfter_s)).status, TagStatus::kConverged);
  EXPECT_EQ(map.best(kTag, nullptr, at(5.1 + kStaleAfter_s)).status, TagStatus::kStale);
  const TagEstimate open = estimate({1.0, 0.0, 0.0}, 0.2, 200.0);
  EXPECT_EQ(map.best(kTag, &open, at(200.0)).status, TagStatus::kConverged);  // it is being read
}

}  // namespace
}  // namespace rfmvo
