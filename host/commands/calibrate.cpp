// rfmvo calibrate: the camera, from pictures of a board.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calibrate/camera_calibration.hpp"
#include "calibrate/pictures.hpp"
#include "commands/commands.hpp"
#include "commands/json_output.hpp"
#include "commands/overwrite.hpp"
#include "commands/progress_line.hpp"
#include "commands/whole_file.hpp"
#include "config/config.hpp"

namespace rfmvo {
namespace {

struct BoardOptions {
  calibrate::Board board;
  std::string kind = "checkerboard";
  [[nodiscard]] calibrate::Board chosen() const {
    calibrate::Board b = board;
    b.kind = kind == "charuco" ? calibrate::BoardKind::kCharuco : calibrate::BoardKind::kCheckerboard;
    return b;
  }
};

struct CameraOptions {
  BoardOptions board;
  calibrate::PictureSources sources;
  double every_s = 0.5;
  std::string model = "radtan", out, page;
  bool force = false;
  JsonOutput json;
};

void add_board_options(CLI::App& command, BoardOptions& options) {
  command.add_option("--board", options.kind, "What is printed on the board")
      ->check(CLI::IsMember({"checkerboard", "charuco"}))
      ->capture_default_str();
  command.add_option("--columns", options.board.columns, "Checkerboard: inner corners in a row; ChArUco: squares")
      ->capture_default_str();
  command.add_option("--rows", options.board.rows, "The same downwards")->capture_default_str();
  command.add_option("--square-m", options.board.square_m, "Side of a square")->capture_default_str();
  command.add_option("--marker-m", options.board.marker_m, "ChArUco: side of a marker; default: 3/4 of the square");
  command.add_option("--dictionary", options.board.dictionary, "ChArUco: OpenCV's name of the markers' set")
      ->capture_default_str();
}

struct Found {
  std::vector<calibrate::View> views;
  std::size_t pictures = 0;
  int width_px = 0, height_px = 0;
};

Result<Found> find_boards(const CameraOptions& options) {
  Found found;
  const ProgressLine line("");
  const Status read =
      calibrate::for_each_picture(options.sources, [&](const cv::Mat& grey, const std::string& name) -> Status {
        if (found.pictures == 0) found.width_px = grey.cols, found.height_px = grey.rows;
        if (grey.cols != found.width_px || grey.rows != found.height_px)
          return Error{ErrorCode::kMalformed,
                       fmt::format("has {} x {} px, the pictures before {} x {}", grey.cols, grey.rows, found.width_px,
                                   found.height_px),
                       name};
        ++found.pictures;
        if (auto view = calibrate::find_board(options.board.chosen(), grey, name))
          found.views.push_back(std::move(*view));
        line.say(fmt::format("{} pictures, the board in {}", found.pictures, found.views.size()));
        return Done{};
      });
  if (!read) return read.error();
  return found;
}

std::string to_json(const calibrate::CameraCalibration& c, const Found& found) {
  const CameraModel& m = c.camera;
  return nlohmann::ordered_json{{"pictures", found.pictures},
                                {"used", c.views},
                                {"left_out", c.left_out},
                                {"corners", c.residuals.size()},
                                {"rms_px", c.rms_px},
                                {"fx_px", m.fx_px},
                                {"fy_px", m.fy_px},
                                {"cx_px", m.cx_px},
                                {"cy_px", m.cy_px},
                                {"focal_sigma_px", c.focal_sigma_px},
                                {"centre_sigma_px", c.centre_sigma_px},
                                {"advice", calibrate::advice(c)}}
             .dump(2) +
         "\n";
}

void print(const calibrate::CameraCalibration& c, const Found& found, const std::string& out) {
  fmt::print("{} pictures, the board in {}, {} used; {} corners, error {:.3f} px RMS\n", found.pictures,
             found.views.size(), c.views.size(), c.residuals.size(), c.rms_px);
  fmt::print("focal length {:.2f} {:.2f} px", c.camera.fx_px, c.camera.fy_px);
  if (c.focal_sigma_px > 0.0) fmt::print(" ± {:.2f}", c.focal_sigma_px);
  fmt::print(", centre {:.2f} {:.2f} px", c.camera.cx_px, c.camera.cy_px);
  if (c.centre_sigma_px > 0.0) fmt::print(" ± {:.2f}", c.centre_sigma_px);
  fmt::print("\n");
  for (const std::string& sentence : calibrate::advice(c)) fmt::print("to do: {}\n", sentence);
  fmt::print("{}\n", out);
}

Status run_camera(const CameraOptions& options) {
  if (const Status s = calibrate::check(options.board.chosen()); !s) return s;
  if (const Status s = check_free({options.out, options.page}, options.force); !s) return s;
  const auto found = find_boards(options);
  if (!found) return found.error();
  const Distortion model = options.model == "equidistant" ? Distortion::kEquidistant : Distortion::kRadtan;
  const auto calibration =
      calibrate::calibrate_camera(found.value().views, found.value().width_px, found.value().height_px, model);
  if (!calibration) return Error{calibration.error().code, calibration.error().what, options.sources.inputs.front()};
  if (!options.page.empty()) {
    const auto page = calibrate::calibration_page(calibration.value());
    if (!page) return page.error();
    if (const Status s = write_whole_file(options.page, page.value()); !s) return s;
  }
  if (const Status s = write_whole_file(options.out, calibrate::to_kalibr_yaml(calibration.value())); !s) return s;
  if (const Status s = options.json.write(to_json(calibration.value(), found.value())); !s) return s;
  if (!options.json.on_stdout()) print(calibration.value(), found.value(), options.out);
  return Done{};
}

void add_camera(CLI::App& group, int& exit_code) {
  auto options = std::make_shared<CameraOptions>();
  CLI::App* command = group.add_subcommand("camera", "The lens, from pictures of a checkerboard or ChArUco board");
  command->add_option("pictures", options->sources.inputs, "Pictures, folders of pictures, journals (.lcmlog)")
      ->required();
  command->add_option("--out", options->out, "Camera file to write, as of Kalibr (.yaml)")->required();
  add_board_options(*command, options->board);
  command->add_option("--model", options->model, "Lens: radtan, or equidistant for a fisheye")
      ->check(CLI::IsMember({"radtan", "equidistant"}))
      ->capture_default_str();
  command->add_option("--every-s", options->every_s, "Of a journal: one frame in this time")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--page", options->page, "Write residuals and coverage as a page (.html; needs gnuplot)");
  add_force_option(*command, options->force);
  options->json.add_to(*command, &options->force);
  options->sources.prefix = LcmConfig{}.prefix;
  command->add_option("--prefix", options->sources.prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    options->sources.every = Duration::from_seconds(options->every_s);
    const Status status = run_camera(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo calibrate camera: {}\n", status.error().text());
    exit_code = 1;
  });
}

struct PrintOptions {
  BoardOptions board;
  std::string out;
  int square_px = 120;
  bool force = false;
};

Status run_board(const PrintOptions& options) {
  if (const Status s = check_free({options.out}, options.force); !s) return s;
  const auto picture = calibrate::draw_board(options.board.chosen(), options.square_px);
  if (!picture) return picture.error();
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", picture.value(), png))
    return Error{ErrorCode::kUnwritable, "no PNG could be made", options.out};
  return write_whole_file(options.out, {reinterpret_cast<const char*>(png.data()), png.size()});
}

void add_board(CLI::App& group, int& exit_code) {
  auto options = std::make_shared<PrintOptions>();
  CLI::App* command =
      group.add_subcommand("board", "A board to print; measure a square of what came out of the printer");
  command->add_option("--out", options->out, "Picture to write (.png)")->required();
  add_board_options(*command, options->board);
  command->add_option("--square-px", options->square_px, "Pixels of a square")
      ->check(CLI::Range(10, 1000))
      ->capture_default_str();
  add_force_option(*command, options->force);
  command->callback([options, &exit_code] {
    const Status status = run_board(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo calibrate board: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace

void add_calibrate_command(CLI::App& app, int& exit_code) {
  CLI::App* group = app.add_subcommand("calibrate", "Calibrate the camera");
  group->require_subcommand(1);
  add_camera(*group, exit_code);
  add_board(*group, exit_code);
}

}  // namespace rfmvo
