#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "simulate/image_folder.hpp"
#include "simulate/simulation.hpp"

namespace rfmvo::simulate {
namespace {

namespace fs = std::filesystem;

class ImageFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) /
            ("rfmvo_images_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(root_);
    fs::create_directories(root_ / "images");
    put("calib.txt", "# fx fy cx cy width height model\n500 501 320 240 640 480 radtan 0.1 -0.2 0.001 0.002 0.05\n");
    put("times.txt", "# t filename\n0.0 images/a.png\n0.1 images/b.png\n0.2 images/c.png\n");
    put("groundtruth.txt", "0.05 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n0.3 3 0 0 0 0 0 1\n");
    for (const char* name : {"images/a.png", "images/b.png", "images/c.png"})
      put(name, std::string("bytes of ") + name);
  }
  void TearDown() override { fs::remove_all(root_); }

  void put(const std::string& name, const std::string& text) const { std::ofstream(root_ / name) << text; }
  [[nodiscard]] std::string error_text() const {
    const auto folder = read_image_folder(root_.string());
    return folder.ok() ? "" : folder.error().text();
  }

  fs::path root_;
};

TEST_F(ImageFolderTest, ReadsCameraTruthAndTheImagesThatHaveTruth) {
  const ImageFolder folder = read_image_folder(root_.string()).value();
  EXPECT_EQ(folder.camera.fy_px, 501.0);
  EXPECT_EQ(folder.camera.radtan[4], 0.05);
  ASSERT_EQ(folder.images.size(), 2U);  // the first is earlier than the truth
  EXPECT_EQ(folder.images[0].t_s, 0.1);
  EXPECT_EQ(folder.images[0].encoding, "png");
  EXPECT_NEAR(pose_at(folder.truth, 0.2).t.x(), 2.0, 1e-12);
  EXPECT_EQ(pose_at(folder.truth, 9.0).t.x(), 3.0);
}

TEST_F(ImageFolderTest, AMissingImageIsNamedWithItsLine) {
  fs::remove(root_ / "images/b.png");
  EXPECT_NE(error_text().find("times.txt:3"), std::string::npos) << error_text();
  EXPECT_NE(error_text().find("b.png"), std::string::npos) << error_text();
}

TEST_F(ImageFolderTest, MalformedLinesAreNamed) {
  put("groundtruth.txt", "0.05 0 0 0 0 0 0 1\n0.1 1 0 zero 0 0 0 1\n");
  EXPECT_NE(error_text().find("groundtruth.txt:2"), std::string::npos) << error_text();
  put("groundtruth.txt", "0.05 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 0\n");
  EXPECT_NE(error_text().find("norm"), std::string::npos) << error_text();
  put("groundtruth.txt", "0.05 0 0 0 0 0 0 1\n0.05 1 0 0 0 0 0 1\n");
  EXPECT_NE(error_text().find("increase"), std::string::npos) << error_text();
  put("calib.txt", "500 500 320\n");
  EXPECT_NE(error_text().find("calib.txt:1"), std::string::npos) << error_text();
}

TEST_F(ImageFolderTest, AMissingFileIsNamed) {
  fs::remove(root_ / "groundtruth.txt");
  EXPECT_NE(error_text().find("groundtruth.txt"), std::string::npos) << error_text();
}

TEST_F(ImageFolderTest, FramesCarryTheOriginalBytes) {
  Options options;
  options.images_dir = root_.string();
  std::vector<Frame> frames;
  const auto truth = simulate(options, [&](const Event& event) -> Status {
    if (const Frame* frame = std::get_if<Frame>(&event)) frames.push_back(*frame);
    return Done{};
  });
  ASSERT_TRUE(truth.ok());
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(std::string(frames[0].encoded->begin(), frames[0].encoded->end()), "bytes of images/b.png");
  EXPECT_EQ(frames[0].grey, nullptr);
  EXPECT_EQ(truth.value().tags.size(), 8U);
}

}  // namespace
}  // namespace rfmvo::simulate
