// rfmvo calibrate camera: pictures of a board through a lens that is known.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibrate/camera_calibration.hpp"
#include "edges/camera_file.hpp"
#include "host/host_command.hpp"
#include "support/textured_scene.hpp"

namespace rfmvo {
namespace {

using calibrate::Board;
using calibrate::BoardKind;
using testing::expect_one_line;
using ::testing::HasSubstr;
using testing::in_quotes;
using testing::TemporaryFolder;
using Json = nlohmann::json;

constexpr int kSquare_px = 60;

CameraModel true_camera(Distortion distortion) {
  CameraModel camera{640, 480, 520.0, 515.0, 325.0, 236.0, {}};
  camera.distortion = distortion;
  if (distortion == Distortion::kRadtan)
    camera.radtan = {-0.2, 0.05, 0.001, -0.0005, 0.0};
  else
    camera.equidistant = {-0.02, 0.01, -0.003, 0.0005};
  return camera;
}

Board board_of(BoardKind kind) {
  Board board;
  board.kind = kind;
  board.columns = kind == BoardKind::kCharuco ? 10 : 9;
  board.rows = kind == BoardKind::kCharuco ? 7 : 6;
  return board;
}

// The board from many sides: near and far, tilted, in every corner of the picture.
std::vector<cv::Mat> pictures_of(const Board& board, const CameraModel& camera) {
  const cv::Mat sheet = calibrate::draw_board(board, kSquare_px).value();
  const double width_m = board.square_m * sheet.cols / kSquare_px, height_m = board.square_m * sheet.rows / kSquare_px;
  const TexturedPlane plane{sheet, {-0.5 * width_m, -0.5 * height_m, 0.0}, {width_m, 0.0, 0.0}, {0.0, height_m, 0.0}};
  std::vector<cv::Mat> pictures;
  for (int k = 0; k < 20; ++k) {
    const double tilt_x = 0.55 * std::sin(1.7 * k), tilt_y = 0.55 * std::cos(2.3 * k);
    const double distance = 0.36 + 0.06 * (k % 3);
    const Eigen::Vector3d aside(0.11 * (k % 3 - 1), 0.08 * (k / 3 % 3 - 1), 0.0);
    const Rigid3 T_C_W{so3_exp({tilt_x, tilt_y, 0.1 * std::sin(k)}), aside + Eigen::Vector3d(0, 0, distance)};
    cv::Mat picture = render({plane}, camera, T_C_W.inverse());
    cv::GaussianBlur(picture, picture, {3, 3}, 0.8);
    pictures.push_back(picture);
  }
  return pictures;
}

struct Case {
  BoardKind board;
  Distortion lens;
};

class CalibrateCamera : public ::testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(BoardsAndLenses, CalibrateCamera,
                         ::testing::Values(Case{BoardKind::kCheckerboard, Distortion::kRadtan},
                                           Case{BoardKind::kCharuco, Distortion::kRadtan},
                                           Case{BoardKind::kCheckerboard, Distortion::kEquidistant}));

// What counts: where the estimated lens sends a direction, against the true one.
TEST_P(CalibrateCamera, FindsTheLensToAFractionOfAPixel) {
  const Board board = board_of(GetParam().board);
  const CameraModel truth = true_camera(GetParam().lens);
  std::vector<calibrate::View> views;
  int k = 0;
  for (const cv::Mat& picture : pictures_of(board, truth))
    if (auto view = calibrate::find_board(board, picture, std::to_string(k++))) views.push_back(*view);
  ASSERT_GE(views.size(), 12u);
  const auto result = calibrate::calibrate_camera(views, truth.width_px, truth.height_px, GetParam().lens);
  ASSERT_TRUE(result.ok()) << result.error().text();
  const auto& c = result.value();
  EXPECT_LT(c.rms_px, 0.3);
  EXPECT_NEAR(c.camera.fx_px / truth.fx_px, 1.0, 0.005);
  EXPECT_NEAR(c.camera.fy_px / truth.fy_px, 1.0, 0.005);
  EXPECT_NEAR(c.camera.cx_px, truth.cx_px, 2.0);
  EXPECT_NEAR(c.camera.cy_px, truth.cy_px, 2.0);
  double worst = 0.0;
  for (double x = 60; x < 600; x += 40)
    for (double y = 60; y < 440; y += 40) {
      const Eigen::Vector2d pixel(x, y);
      const Eigen::Vector2d again = project(c.camera, unproject(truth, pixel));
      // The mount turns the camera: a common shift is no error of the lens.
      const Eigen::Vector2d shift = project(c.camera, unproject(truth, {320, 240})) - Eigen::Vector2d(320, 240);
      worst = std::max(worst, (again - shift - pixel).norm());
    }
  EXPECT_LT(worst, 1.5);
}

TEST_P(CalibrateCamera, ItsFileIsReadBackAsItIs) {
  calibrate::CameraCalibration c;
  c.camera = true_camera(GetParam().lens);
  const auto back = parse_camera_yaml(calibrate::to_kalibr_yaml(c), "written");
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_EQ(back.value().fx_px, c.camera.fx_px);
  EXPECT_EQ(back.value().cy_px, c.camera.cy_px);
  EXPECT_EQ(back.value().width_px, c.camera.width_px);
  EXPECT_EQ(back.value().distortion, c.camera.distortion);
  EXPECT_EQ(back.value().radtan, c.camera.radtan);
  EXPECT_EQ(back.value().equidistant, c.camera.equidistant);
}

TEST(CalibrateAdvice, NamesThePlacesWithoutCornersAndAsksForTilt) {
  calibrate::CameraCalibration c;
  c.camera = true_camera(Distortion::kRadtan);
  for (int k = 0; k < 20; ++k) {
    c.views.push_back(std::to_string(k));
    c.tilt_rad.push_back(0.05);
    // Everywhere but in the lower right.
    for (double x = 5; x < 640; x += 30)
      for (double y = 5; y < 480; y += 30)
        if (x < 426 || y < 320) c.residuals.push_back({{x, y}, {0.1, 0.0}, 0});
  }
  const auto sentences = calibrate::advice(c);
  ASSERT_EQ(sentences.size(), 2u);
  EXPECT_THAT(sentences[0], HasSubstr("bring the board there: lower right"));
  EXPECT_THAT(sentences[1], HasSubstr("tilt it"));
}

TEST(CalibrateViews, OneThatFitsNoCameraIsLeftOut) {
  const Board board = board_of(BoardKind::kCheckerboard);
  std::vector<calibrate::View> views;
  int k = 0;
  for (const cv::Mat& picture : pictures_of(board, true_camera(Distortion::kRadtan)))
    if (auto view = calibrate::find_board(board, picture, std::to_string(k++))) views.push_back(*view);
  ASSERT_GE(views.size(), 12u);
  std::swap(views[3].image_px[10], views[3].image_px[40]);
  const auto result = calibrate::calibrate_camera(views, 640, 480, Distortion::kRadtan);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.value().left_out, std::vector<std::string>{views[3].name});
  EXPECT_LT(result.value().rms_px, 0.3);
}

TEST(CalibrateCommand, GoesFromAFolderOfPicturesToACameraFile) {
  const TemporaryFolder folder;
  int k = 0;
  std::filesystem::create_directories(folder / "pictures");
  for (const cv::Mat& picture : pictures_of(board_of(BoardKind::kCheckerboard), true_camera(Distortion::kRadtan)))
    cv::imwrite(folder / ("pictures/" + std::to_string(k++) + ".png"), picture);
  const std::string command =
      "calibrate camera " + in_quotes(folder / "pictures") + " --out " + in_quotes(folder / "cam.yaml");
  const auto result = testing::rfmvo(command + " --json --page " + in_quotes(folder / "page.html"));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json.at("pictures"), 20);
  EXPECT_LT(json.at("rms_px").get<double>(), 0.3);
  const auto camera = read_camera_file(folder / "cam.yaml");
  ASSERT_TRUE(camera.ok()) << camera.error().text();
  EXPECT_EQ(camera.value().fx_px, json.at("fx_px").get<double>());
  EXPECT_THAT(testing::read_file(folder / "page.html"), HasSubstr("<svg"));
  expect_one_line(testing::rfmvo(command), "cam.yaml: is there already; --force overwrites it");
  EXPECT_EQ(testing::rfmvo(command + " --force").exit_code, 0);
}

TEST(CalibrateCommand, TakesTheFramesOfAJournal) {
  const TemporaryFolder folder;
  std::vector<Event> events = {testing::sample_start()};
  int k = 0;
  for (const cv::Mat& picture : pictures_of(board_of(BoardKind::kCheckerboard), true_camera(Distortion::kRadtan))) {
    events.push_back(frame_of(picture, 1'700'000'000.0 + k, k));
    ++k;
  }
  testing::write_journal(folder / "run.lcmlog", events);
  const auto result = testing::rfmvo("calibrate camera " + in_quotes(folder / "run.lcmlog") +
                                     " --every-s 2 --json --out " + in_quotes(folder / "cam.yaml"));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(Json::parse(result.out).at("pictures"), 10);
}

TEST(CalibrateCommand, BadInputIsOneLine) {
  const TemporaryFolder folder;
  const std::string out = " --out " + in_quotes(folder / "c.yaml");
  expect_one_line(testing::rfmvo("calibrate camera /nowhere" + out), "/nowhere: no such file or folder");
  expect_one_line(testing::rfmvo("calibrate camera " + in_quotes(folder / "") + out), "holds no pictures");
  testing::write_file(folder / "x.png", "no picture");
  expect_one_line(testing::rfmvo("calibrate camera " + in_quotes(folder / "x.png") + out),
                  "x.png: no picture that can be read");
  cv::imwrite(folder / "grey.png", cv::Mat(480, 640, CV_8UC1, cv::Scalar(90)));
  expect_one_line(testing::rfmvo("calibrate camera " + in_quotes(folder / "grey.png") + out),
                  "the board was found in 0 pictures");
  expect_one_line(testing::rfmvo("calibrate camera x --board charuco --dictionary 9X9" + out),
                  "9X9: unknown dictionary");
  expect_one_line(testing::rfmvo("calibrate camera x --board wall" + out), "--board", 2);
  expect_one_line(testing::rfmvo("calibrate"), "subcommand", 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "c.yaml"));
}

}  // namespace
}  // namespace rfmvo
