// Calibrations of other tools: the same camera, however it is written.
#include <gtest/gtest.h>

#include "edges/camera_file.hpp"

namespace rfmvo {
namespace {

constexpr const char* kKalibr = R"(cam0:
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.8e-05]
  distortion_model: radtan
  intrinsics: [458.654, 457.296, 367.215, 248.375]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
)";

constexpr const char* kOpenCv = R"(%YAML:1.0
---
calibration_time: "today"
image_width: 752
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 458.654, 0., 367.215, 0., 457.296, 248.375, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.28, 0.07, 0.0002, 1.8e-05, 0. ]
)";

constexpr const char* kRos = R"(image_width: 752
image_height: 480
camera_name: narrow
camera_matrix:
  rows: 3
  cols: 3
  data: [458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.28, 0.07, 0.0002, 1.8e-05, 0]
)";

constexpr const char* kRosMessage = R"(header: {seq: 1, frame_id: camera}
height: 480
width: 752
distortion_model: "plumb_bob"
D: [-0.28, 0.07, 0.0002, 1.8e-05, 0.0]
K: [458.654, 0.0, 367.215, 0.0, 457.296, 248.375, 0.0, 0.0, 1.0]
)";

TEST(CameraFile, TheSameCameraInFourFormatsIsTheSame) {
  for (const char* yaml : {kKalibr, kOpenCv, kRos, kRosMessage}) {
    const auto camera = parse_camera_yaml(yaml, "camera.yaml");
    ASSERT_TRUE(camera.ok()) << camera.error().text();
    const CameraModel& c = camera.value();
    EXPECT_EQ(c.width_px, 752);
    EXPECT_EQ(c.height_px, 480);
    EXPECT_EQ(c.fx_px, 458.654);
    EXPECT_EQ(c.fy_px, 457.296);
    EXPECT_EQ(c.cx_px, 367.215);
    EXPECT_EQ(c.cy_px, 248.375);
    EXPECT_EQ(c.distortion, Distortion::kRadtan);
    EXPECT_EQ(c.radtan, (std::array<double, 5>{-0.28, 0.07, 0.0002, 1.8e-05, 0.0}));
  }
}

TEST(CameraFile, FisheyeLensesAreTold) {
  const char* kalibr = R"(cam0: {camera_model: pinhole, intrinsics: [190, 191, 250, 255], distortion_model: equidistant,
  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002], resolution: [512, 512]})";
  const char* opencv = R"(%YAML:1.0
image_width: 512
image_height: 512
fisheye_model: 1
camera_matrix: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [190, 0, 250, 0, 191, 255, 0, 0, 1]}
distortion_coefficients: !!opencv-matrix {rows: 4, cols: 1, dt: d, data: [0.003, 0.0007, -0.002, 0.0002]}
)";
  for (const char* yaml : {kalibr, opencv}) {
    const auto camera = parse_camera_yaml(yaml, "fisheye.yaml");
    ASSERT_TRUE(camera.ok()) << camera.error().text();
    EXPECT_EQ(camera.value().distortion, Distortion::kEquidistant);
    EXPECT_EQ(camera.value().equidistant, (std::array<double, 4>{0.003, 0.0007, -0.002, 0.0002}));
  }
}

struct Wrong {
  const char* yaml;
  const char* said;
};

TEST(CameraFile, WhatIsWrongIsNamedWithTheFile) {
  const Wrong wrongs[] = {
      {"[1, 2", "c.yaml:1"},
      {"just text", "c.yaml: holds no camera calibration"},
      {"cam0: {camera_model: omni, intrinsics: [1, 2, 3, 4], resolution: [6, 4]}", "\"omni\" is not supported"},
      {"cam0: {intrinsics: [100, 100, 3, 4]}", "c.yaml: holds no image size"},
      {"cam0: {intrinsics: [100, 100, 3], resolution: [6, 4]}", "c.yaml: holds no camera matrix"},
      {"cam0: {intrinsics: [.nan, 100, 3, 4], resolution: [6, 4]}", "not finite"},
      {"cam0: {intrinsics: [-5, 100, 3, 4], resolution: [6, 4]}", "not positive"},
      {"cam0: {intrinsics: [a, 100, 3, 4], resolution: [6, 4]}", "c.yaml:1"},
      {"{K: [5, 0, 3, 0, 5, 2, 0, 0, 1], D: [0, 0, 0, 0, 0, 0, 0, 0.1], width: 6, height: 4}", "not supported"},
      {"{K: [5, 0, 3, 0, 5, 2, 0, 0, 1], D: [0.1, 0], width: 6, height: 4}", "4 or 5 distortion numbers"},
  };
  for (const Wrong& wrong : wrongs) {
    const auto camera = parse_camera_yaml(wrong.yaml, "c.yaml");
    ASSERT_FALSE(camera.ok()) << wrong.yaml;
    EXPECT_NE(camera.error().text().find(wrong.said), std::string::npos) << camera.error().text();
  }
}

TEST(CameraFile, OtherNamesAreRefused) {
  EXPECT_EQ(read_camera_file("lens.json").error().text(), "lens.json: a camera file is .yaml, .yml, .toml or .txt");
}

}  // namespace
}  // namespace rfmvo
