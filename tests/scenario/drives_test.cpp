// The odometry on rendered drives past a shelf, through `rfmvo vo`'s own figures. Bounds: twice as good as ORB-SLAM2
// (0.10 % of the path, 0.7 % of scale from half to half) and SVO (0.12 %, 1.2 %) on such drives, or as good.
#include <gtest/gtest.h>

#include "edges/lcm_codec.hpp"
#include "odometry/odometry_report.hpp"
#include "odometry/odometry_run.hpp"
#include "simulate/simulation.hpp"
#include "vision/visual_odometry.hpp"

namespace rfmvo {
namespace {

struct Drive {
  odometry::Run run;
  simulate::Truth truth;
};

// As an image folder would be run: nothing known about the lens but its focal length and centre.
Drive drive(const std::string& scene, double duration_s) {
  simulate::Options options;
  options.scene = scene;
  options.duration_s = duration_s;
  Drive result;
  std::optional<VisualOdometry> vo;
  const auto sink = [&](const Event& event) -> Status {
    if (const auto* start = std::get_if<Start>(&event)) vo.emplace(VisionConfig{}, start->calibration.camera);
    const auto* picture = std::get_if<Frame>(&event);
    if (!picture) return Done{};
    Frame frame = *picture;
    if (const Status s = decode_image(frame); !s) return s;
    result.run.poses.push_back(vo->on(frame));
    return Done{};
  };
  auto truth = simulate::simulate(options, sink);
  EXPECT_TRUE(truth.ok());
  if (truth.ok()) result.truth = std::move(truth).value();
  return result;
}

class ShelfDrive : public testing::TestWithParam<const char*> {};

TEST_P(ShelfDrive, IsTrackedToATenthOfAPercent) {
  const Drive d = drive(GetParam(), 9.0);
  const auto figures = odometry::path_figures(odometry::live_path(d.run), d.truth.trajectory);
  ASSERT_TRUE(figures.has_value());
  std::printf("%s: Sim3 %.3f %%, half scale %.2f %%, step %.2f mm, NEES per dof %.2f\n", GetParam(),
              figures->ate_sim3_percent(), 100.0 * figures->half_scale_median.value_or(-0.01),
              1e3 * figures->step_noise_m, figures->nees.value_or(-1.0));
  EXPECT_LE(figures->ate_sim3_percent(), 0.12);
  EXPECT_LE(figures->step_noise_m, 0.001);
  ASSERT_TRUE(figures->half_scale_median.has_value());
  EXPECT_LE(*figures->half_scale_median, 0.005);
  ASSERT_TRUE(figures->nees.has_value());
  // 1 if exact. The drives in full (rfmvo vo): 0.50 to 1.6; these 9 s have fewer errors to average over, and the first
  // second of each, while the images have not yet confirmed the lens, counts more: 0.42 to 1.63.
  EXPECT_GE(*figures->nees, 0.3);
  EXPECT_LE(*figures->nees, 2.0);
  std::size_t with_pose = 0;
  for (const CameraPose& p : d.run.poses) {
    with_pose += odometry::has_pose(p);
    EXPECT_EQ(p.segment, 0U);
  }
  EXPECT_GT(with_pose, d.run.poses.size() - 30);  // started within a second
}

INSTANTIATE_TEST_SUITE_P(Drives, ShelfDrive,
                         testing::Values("shelf05", "shelf1", "shelf1rs", "shelfturn", "shelfstop", "shelfdiag"),
                         [](const auto& param) { return std::string(param.param); });

TEST(Crowd, PeopleAndForkLiftsDoNotBreakTheSegment) {
  const Drive d = drive("crowd", 10.0);
  const auto figures = odometry::path_figures(odometry::live_path(d.run), d.truth.trajectory);
  ASSERT_TRUE(figures.has_value());
  EXPECT_LE(figures->ate_sim3_percent(), 0.3);
  for (const CameraPose& p : d.run.poses) EXPECT_EQ(p.segment, 0U);
}

}  // namespace
}  // namespace rfmvo
