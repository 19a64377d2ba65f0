#include <gtest/gtest.h>

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
