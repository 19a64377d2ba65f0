// Corners, optical flow and patch alignment on small pictures whose motion is known.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "support/textured_scene.hpp"
#include "vision/corners.hpp"
#include "vision/optical_flow.hpp"
#include "vision/patch_alignment.hpp"

namespace rfmvo {
namespace {

TEST(Corners, AtMostOnePerCellAndNoneWhereOneIs) {
  const cv::Mat grey = texture(320, 240, 1);
  const auto corners = find_corners(grey, {}, 100, 100);
  ASSERT_GT(corners.size(), 60U);
  EXPECT_LE(corners.size(), 100U);
  const int size = static_cast<int>(std::sqrt(320.0 * 240.0 / 100.0));
  std::set<std::pair<int, int>> cells;
  for (const auto& c : corners)
    EXPECT_TRUE(cells.insert({static_cast<int>(c.x) / size, static_cast<int>(c.y) / size}).second);
  for (const auto& c : find_corners(grey, corners, 100, 100)) {
    EXPECT_FALSE(cells.contains({static_cast<int>(c.x) / size, static_cast<int>(c.y) / size}));
  }
}

TEST(Corners, BlackAndWhiteImagesHaveNone) {
  EXPECT_TRUE(find_corners(cv::Mat(240, 320, CV_8UC1, cv::Scalar(0)), {}, 100, 100).empty());
  EXPECT_TRUE(find_corners(cv::Mat(240, 320, CV_8UC1, cv::Scalar(255)), {}, 100, 100).empty());
}

TEST(OpticalFlow, FollowsAShiftToATenthOfAPixel) {
  const cv::Mat first = texture(320, 240, 2);
  const cv::Point2f shift(6.3F, -3.7F);
  const cv::Mat second = shifted(first, shift);
  const auto corners = find_corners(first(cv::Rect(20, 20, 280, 200)), {}, 80, 80);
  std::vector<cv::Point2f> from;
  for (const auto& c : corners) from.push_back(c + cv::Point2f(20, 20));
  const auto flow = follow(build_pyramid(first), build_pyramid(second), from, from);
  int good = 0;
  for (std::size_t i = 0; i < from.size(); ++i) good += flow[i].ok && cv::norm(flow[i].at_px - from[i] - shift) < 0.1;
  EXPECT_GT(good, static_cast<int>(0.9 * static_cast<double>(from.size())));
}

TEST(PatchAlignment, FindsAPatchThatIsShiftedAndDarker) {
  const cv::Mat first = texture(320, 240, 3);
  const cv::Point2f shift(3.4F, 2.2F);
  cv::Mat second;
  shifted(first, shift).convertTo(second, CV_8UC1, 0.7, 10.0);
  const Pyramid a = build_pyramid(first), b = build_pyramid(second);
  int found = 0, all = 0;
  for (const auto& c : find_corners(first, {}, 60, 60)) {
    if (!cv::Rect(40, 40, 240, 160).contains(cv::Point(c))) continue;
    ++all;
    const auto at = align_patch(a, b, {c, c, Eigen::Matrix2d::Identity()}, 2);
    found += at && cv::norm(*at - c - shift) < 0.15;
  }
  EXPECT_GT(found, static_cast<int>(0.8 * all));
}

TEST(PatchAlignment, RefusesAnotherPlace) {
  const Pyramid a = build_pyramid(texture(320, 240, 4)), b = build_pyramid(texture(320, 240, 5));
  int found = 0, all = 0;
  for (const auto& c : find_corners(a[0], {}, 60, 60)) {
    ++all;
    found += align_patch(a, b, {c, c, Eigen::Matrix2d::Identity()}, 2).has_value();
  }
  EXPECT_LT(found, static_cast<int>(0.1 * all));
}

}  // namespace
}  // namespace rfmvo
