#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulate/renderer.hpp"
#include "simulate/scene.hpp"

namespace rfmvo::simulate {
namespace {

TexturePointer plain(float grey) { return std::make_shared<const Texture>(2, std::vector<float>(16, grey)); }

// Faces a camera at the origin that looks along +y (image right = x, image down = -z).
Surface facing(double left_m, double top_m, double distance_m, double width_m, double height_m,
               TexturePointer texture) {
  return {{left_m, distance_m, top_m},
          Eigen::Vector3d::UnitX(),
          -Eigen::Vector3d::UnitZ(),
          width_m,
          height_m,
          std::move(texture),
          {4, 4},
          1.0F};
}

const Rigid3 kLooking{looking_left(), Eigen::Vector3d::Zero()};

std::uint8_t pixel(const std::vector<std::uint8_t>& grey, const CameraModel& camera, int x, int y) {
  return grey[static_cast<std::size_t>(y * camera.width_px + x)];
}

TEST(Renderer, PutsASurfaceWhereTheCameraModelSays) {
  const CameraModel camera;
  Environment e;
  e.surfaces.push_back(facing(0.2, 0.3, 2.0, 0.4, 0.2, plain(200)));
  const auto grey = render(e, camera, kLooking);
  const Eigen::Vector2d upper_left = project(camera, {0.1, -0.15});
  const Eigen::Vector2d lower_right = project(camera, {0.3, -0.05});
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) {
      const bool inside = x >= upper_left.x() && x <= lower_right.x() && y >= upper_left.y() && y <= lower_right.y();
      ASSERT_EQ(pixel(grey, camera, x, y) == 200, inside) << x << " " << y;
    }
  }
}

TEST(Renderer, NearSurfacesHideFarOnesInAnyOrder) {
  const CameraModel camera;
  for (const bool near_first : {true, false}) {
    Environment e;
    const Surface near = facing(-0.2, 0.2, 1.0, 0.4, 0.4, plain(220)), far = facing(-2, 2, 3.0, 4, 4, plain(90));
    e.surfaces = near_first ? std::vector<Surface>{near, far} : std::vector<Surface>{far, near};
    const auto grey = render(e, camera, kLooking);
    EXPECT_EQ(pixel(grey, camera, 320, 240), 220);
    EXPECT_EQ(pixel(grey, camera, 320, 40), 90);
  }
}

TEST(Renderer, TextureIsProjectivelyExact) {
  // Left half dark, right half bright, seen at a slant: the edge is the projection of the middle.
  const CameraModel camera;
  std::vector<float> halves(64 * 64);
  for (std::size_t i = 0; i < halves.size(); ++i) halves[i] = i % 64 < 32 ? 40.0F : 220.0F;
  Environment e;
  const Eigen::Vector3d slant = Eigen::Vector3d(1.0, 0.8, 0.0).normalized();
  const Surface wall{
      {-0.5, 1.5, 0.5}, slant, -Eigen::Vector3d::UnitZ(), 1.0, 1.0, std::make_shared<const Texture>(6, halves),
      {64, 64},         1.0F};
  e.surfaces.push_back(wall);
  const auto grey = render(e, camera, kLooking);
  const Eigen::Vector3d middle = wall.corner + 0.5 * slant;
  const double edge_px = project(camera, {middle.x() / middle.y(), 0.0}).x();
  EXPECT_LT(pixel(grey, camera, static_cast<int>(edge_px) - 6, 240), 60);
  EXPECT_GT(pixel(grey, camera, static_cast<int>(edge_px) + 6, 240), 200);
}

TEST(Renderer, SurfacesBehindTheCameraDoNotShow) {
  const CameraModel camera;
  Environment e;
  e.surfaces.push_back(facing(-2, 2, -3.0, 4, 4, plain(200)));
  for (const std::uint8_t grey : render(e, camera, kLooking)) ASSERT_NE(grey, 200);
}

// A rolling shutter shows every row as the whole picture would be at that row's time.
TEST(Renderer, ARollingShutterReadsEachRowAtItsTime) {
  const CameraModel camera;
  Environment e;
  e.surfaces.push_back(facing(-3, 2, 1.5, 6, 4, checkerboard_texture(16)));
  e.surfaces.back().texels_per_m = {256, 256};  // squares of 42 px
  const auto path = [](double t_s) {
    return Rigid3{(kLooking.R * so3_exp({0.1 * t_s, 0.3 * t_s, 0.0})).normalized(), {1.0 * t_s, 0.05 * t_s, 0.0}};
  };
  CameraEffects rolling;
  rolling.readout_s = 0.03;
  const auto picture = render_moving(e, camera, path, 0.2, rolling);
  for (const int y : {10, 120, 240, 400, 470}) {
    const auto at_row = render(e, camera, path(0.2 + ((y + 0.5) / camera.height_px - 0.5) * rolling.readout_s));
    int different = 0;
    for (int x = 0; x < camera.width_px; ++x) {
      different += std::abs(pixel(picture, camera, x, y) - pixel(at_row, camera, x, y)) > 8;
    }
    EXPECT_LT(different, 12) << y;  // edges of the squares fall on either side by a hundredth of a pixel
  }
}

TEST(Renderer, MotionBlursAnEdgeByTheWayOfTheExposure) {
  const CameraModel camera;
  Environment e;
  e.surfaces.push_back(facing(0.0, 2, 1.5, 6, 4, plain(200)));
  CameraEffects slow;
  slow.exposure_s = 0.01;
  const auto path = [](double t_s) { return Rigid3{kLooking.R, {1.0 * t_s, 0.0, 0.0}}; };
  const auto picture = render_moving(e, camera, path, 0.0, slow);
  int between = 0;  // neither the wall nor what is beside it
  for (int x = 0; x < camera.width_px; ++x)
    between += pixel(picture, camera, x, 240) > 60 && pixel(picture, camera, x, 240) < 190;
  const double way_px = camera.fx_px * 1.0 * slow.exposure_s / 1.5;
  EXPECT_NEAR(between, way_px, 1.5);
}

TEST(Renderer, TheCrowdCoversUpToTwoFifths) {
  Options options;
  options.scene = "crowd";
  options.frames = false;
  const Scene scene = make_scene(options).value();
  double most = 0.0, mean = 0.0;
  constexpr std::size_t kEvery = 6;  // frames: five a second
  for (std::size_t k = 0; k < scene.frame_times_s.size(); k += kEvery) {
    const double t_s = scene.frame_times_s[k];
    const double share = occluded_share(*scene.environment, scene.calibration.camera, scene.T_S_C(t_s), t_s);
    most = std::max(most, share);
    mean += share * kEvery / static_cast<double>(scene.frame_times_s.size());
  }
  EXPECT_GT(most, 0.3);
  EXPECT_LT(most, 0.42);
  EXPECT_GT(mean, 0.05);
}

TEST(Renderer, EveryDriveShowsSomethingAllTheWay) {
  for (const char* name :
       {"shelf05", "shelf1", "shelf1rs", "shelfturn", "shelfstop", "shelfdiag", "crowd", "dark", "corridor"}) {
    Options options;
    options.scene = name;
    const Scene scene = make_scene(options).value();
    EXPECT_GE(scene.tags.size(), 5U) << name;
    const std::size_t last = scene.frame_times_s.size() - 1;
    for (const std::size_t k : {std::size_t{0}, last / 2, last})
      EXPECT_GT(scene.frame(k).value().encoded->size(), 15'000U) << name;
  }
}

// A drive is continuous: no pose jumps, whatever turns, stops and turning points it has.
TEST(Renderer, DrivesAreSmoothForMinutes) {
  for (const char* name : {"shelf1", "shelfturn", "shelfstop", "corridor"}) {
    Options options;
    options.scene = name;
    options.duration_s = 60.0;
    const Scene scene = make_scene(options).value();
    constexpr double kStep_s = 0.01;
    for (double t_s = 0.0; t_s < 60.0; t_s += kStep_s) {
      const Rigid3 a = scene.T_S_C(t_s), b = scene.T_S_C(t_s + kStep_s);
      ASSERT_LT((a.t - b.t).norm(), 0.02) << name << " " << t_s;
      ASSERT_LT(a.R.angularDistance(b.R), 0.02) << name << " " << t_s;
    }
  }
}

TEST(Renderer, FramesOfTheAisleAreDetailedAndSmall) {
  Options options;
  const Scene scene = make_scene(options).value();
  std::size_t bytes = 0;
  for (const std::size_t k : {0U, 100U, 200U, 300U}) {
    const Frame frame = scene.frame(k).value();
    EXPECT_EQ(frame.encoding, "jpeg");
    EXPECT_EQ(frame.width_px, 640);
    bytes += frame.encoded->size();
  }
  const double journal_mb = 1e-6 * static_cast<double>(bytes) / 4.0 * static_cast<double>(scene.frame_times_s.size());
  EXPECT_LT(journal_mb, 60.0);
  EXPECT_GT(journal_mb, 5.0);  // a picture without detail would be smaller
}

}  // namespace
}  // namespace rfmvo::simulate
