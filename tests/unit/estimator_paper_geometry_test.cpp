#include <gtest/gtest.h>

#include <cmath>

#include "estimator/accuracy_estimation.hpp"
#include "estimator/incident_angles.hpp"
#include "estimator/line_intersection.hpp"
#include "unit/estimator_paper_scene.hpp"

namespace rfmvo {
namespace {

using paper_scene::kPi;

constexpr double kDeg = kPi / 180.0;

TEST(IncidentAngles, InvertsTheirDirection) {
  for (int a = 1; a < 180; a += 7)
    for (int b = 0; b <= 180; b += 9) {
      const IncidentAngles angles{a * kDeg, b * kDeg};
      const Eigen::Vector3d u = direction_of(angles);
      EXPECT_GE(u.z(), -1e-15);  // [0, 180 deg]^2 is one hemisphere
      EXPECT_NEAR((direction_of(angles_of(u)) - u).norm(), 0.0, 1e-12);
    }
}

TEST(AngleAverage, IsFarOffAcrossTheSeamUnlessTakenOnTheSphere) {
  // Two directions 5.5 deg apart on both sides of the seam.
  const IncidentAngles above{2 * kDeg, 16 * kDeg}, below{178 * kDeg, 160 * kDeg};
  const Eigen::Vector3d middle = (direction_of(above) + direction_of(below)).normalized();
  ASSERT_NEAR(std::acos(direction_of(above).dot(direction_of(below))) / kDeg, 5.5, 0.1);
  AngleSums sums;
  sums.add(above, Eigen::Quaterniond::Identity());
  sums.add(below, Eigen::Quaterniond::Identity());
  // Eq. (9): alpha = 90, beta = 88 deg: straight up, though both tags are 18 deg above the horizon.
  EXPECT_NEAR(std::acos(direction_of(sums.mean_angles()).dot(middle)) / kDeg, 72.0, 2.0);
  EXPECT_NEAR((sums.mean_direction_V() - middle).norm(), 0.0, 1e-12);
}

TEST(AngleAverage, BothAgreeAwayFromTheSeam) {
  AngleSums sums;
  for (const double d : {-2.0, 0.0, 2.0}) sums.add({(90 + d) * kDeg, 30 * kDeg}, Eigen::Quaterniond::Identity());
  // Second order in the spread: (2 deg)^2 / 2.
  EXPECT_NEAR((direction_of(sums.mean_angles()) - sums.mean_direction_V()).norm(), 0.0, 6e-4);
}

TEST(LineIntersection, IsExactForLinesThroughOnePoint) {
  const Eigen::Vector3d tag(1.2, 2.0, 0.4);
  std::vector<Line> lines;
  for (const auto& p : paper_scene::weave(60, 1.0)) lines.push_back({p, (tag - p).normalized()});
  const LineIntersection found = nearest_point(lines);
  EXPECT_TRUE(found.determined);
  EXPECT_NEAR((found.point - tag).norm(), 0.0, 1e-10);
}

TEST(LineIntersection, OfTwoSkewLinesIsHalfWay) {
  const std::vector<Line> lines{{{0, 0, 0}, {1, 0, 0}}, {{3, -2, 1}, {0, 1, 0}}};
  const LineIntersection found = nearest_point(lines);
  EXPECT_TRUE(found.determined);
  EXPECT_NEAR((found.point - Eigen::Vector3d(3, 0, 0.5)).norm(), 0.0, 1e-12);
}

TEST(LineIntersection, OfParallelLinesOrNoneIsUndetermined) {
  EXPECT_FALSE(nearest_point({}).determined);
  const std::vector<Line> lines{{{0, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 1, 0}}, {{2, 0, 1}, {0, 1, 0}}};
  const LineIntersection found = nearest_point(lines);
  EXPECT_FALSE(found.determined);
  EXPECT_TRUE(found.point.allFinite());
}

std::vector<Eigen::Vector3d> straight(double length_m) {
  std::vector<Eigen::Vector3d> path;
  for (int i = 0; i < 60; ++i) path.emplace_back(length_m * (i / 59.0 - 0.5), 0.0, 1.0);
  return path;
}

TEST(Hdop, FallsAsTheApertureGrows) {
  double last = 1e9;
  for (const double length : {0.25, 0.5, 1.0, 2.0, 4.0}) {
    const Hdop hdop = horizontal_dilution(straight(length), {0.0, 2.0, 1.3});
    ASSERT_TRUE(hdop.defined);
    EXPECT_LT(hdop.value, last);
    last = hdop.value;
  }
}

TEST(Hdop, GrowsWithTheDistance) {
  const Hdop near = horizontal_dilution(straight(2.0), {0.0, 1.0, 1.0});
  const Hdop far = horizontal_dilution(straight(2.0), {0.0, 4.0, 1.0});
  EXPECT_LT(near.value, far.value);
}

TEST(Hdop, SaysUndefinedWhereBearingsDoNotSpread) {
  const std::vector<Eigen::Vector3d> nothing;
  const std::vector<Eigen::Vector3d> on_the_tag(5, Eigen::Vector3d(0, 2, 1));
  EXPECT_FALSE(horizontal_dilution(nothing, {0, 2, 1}).defined);
  EXPECT_FALSE(horizontal_dilution(on_the_tag, {0, 2, 1}).defined);
  EXPECT_FALSE(horizontal_dilution(straight(2.0), {5, 0, 1}).defined);  // on the line of the antennas
  EXPECT_EQ(horizontal_dilution(straight(2.0), {5, 0, 1}).value, 0.0);
}

}  // namespace
}  // namespace rfmvo
