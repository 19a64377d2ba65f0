#include "edges/image_folder.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using testing::TemporaryFolder;
using testing::write_file;

void write_folder(const TemporaryFolder& folder) {
  write_file(folder / "images/a.png", "");
  cv::imwrite(folder / "images/a.png", cv::Mat(6, 8, CV_8UC1, cv::Scalar(7)));
  cv::imwrite(folder / "images/b.png", cv::Mat(6, 8, CV_8UC1, cv::Scalar(9)));
  write_file(folder / "times.txt", "# t[s] filename\n0.000000 images/a.png\n0.033333 images/b.png\n");
  write_file(folder / "calib.txt", "# fx fy cx cy width height model d0..\n10 11 4 3 8 6 radtan 0.1 0.2 0.3 0.4\n");
}

// All events, or the error's text.
std::string read_all(const std::string& directory, std::vector<Event>* events = nullptr) {
  auto folder = ImageFolder::open(directory.substr(0, directory.find_last_not_of('/') + 1));
  if (!folder) return folder.error().text();
  while (true) {
    auto event = folder.value()->next();
    if (!event) return event.error().text();
    if (!event.value()) return "";
    if (events != nullptr) events->push_back(*event.value());
  }
}

TEST(ImageFolder, GivesAStartWithTheCameraAndAFramePerImage) {
  const TemporaryFolder folder;
  write_folder(folder);
  std::vector<Event> events;
  ASSERT_EQ(read_all(folder / "", &events), "");
  ASSERT_EQ(events.size(), 3u);
  const auto& start = std::get<Start>(events[0]);
  EXPECT_EQ(start.calibration.camera.fy_px, 11.0);
  EXPECT_EQ(start.calibration.camera.radtan[3], 0.4);
  const auto& frame = std::get<Frame>(events[2]);
  EXPECT_EQ(frame.time.us(), 33333);
  EXPECT_EQ(frame.sequence, 1);
  EXPECT_EQ(frame.encoding, "png");
  EXPECT_EQ(*frame.grey, std::vector<std::uint8_t>(48, 9));
}

TEST(ImageFolder, ErrorsNameTheFile) {
  const TemporaryFolder folder;
  write_folder(folder);
  write_file(folder / "times.txt", "0 images/a.png\n0.1 images/missing.png\n");
  EXPECT_EQ(read_all(folder / ""), folder / "images/missing.png: cannot be read: No such file or directory");
  write_file(folder / "times.txt", "0 images/a.png\n0 images/b.png\n");
  EXPECT_EQ(read_all(folder / ""), folder / "times.txt:2: times do not increase");
  write_file(folder / "times.txt", "0\n");
  EXPECT_EQ(read_all(folder / ""), folder / "times.txt:1: expects: time in seconds, file name");
  write_file(folder / "times.txt", "0 images/a.bmp\n");
  EXPECT_EQ(read_all(folder / ""), folder / "times.txt:1: \"images/a.bmp\" is neither .png nor .jpg");
  write_folder(folder);
  write_file(folder / "calib.txt", "10 10 4 3 9 6 none\n");
  EXPECT_EQ(read_all(folder / ""), folder / "images/a.png: the png image has 8 x 6 px, declared are 9 x 6");
  write_file(folder / "calib.txt", "10 10 4 3 8 6 fisheye 0 0 0 0\n");
  EXPECT_EQ(read_all(folder / ""), folder / "calib.txt:1: unknown camera model \"fisheye\"; known: radtan, equidistant, none");
  write_file(folder / "images/a.png", "this is no image");
  write_file(folder / "calib.txt", "10 10 4 3 8 6 none\n");
  EXPECT_EQ(read_all(folder / ""), folder / "images/a.png: the png image cannot be decoded");
}

}  // namespace
}  // namespace rfmvo
