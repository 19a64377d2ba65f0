// A lens from pictures of a board: OpenCV's bundle adjustment, its residuals, and what the pictures leave open.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "calibrate/board.hpp"
#include "geometry/camera_model.hpp"

namespace rfmvo::calibrate {

struct Residual {
  Point2 at_px, error_px;  // seen less predicted
  std::size_t view = 0;
};

struct CameraCalibration {
  CameraModel camera;
  double focal_sigma_px = 0.0, centre_sigma_px = 0.0;  // the larger of both axes, 1 sigma, if errors are independent
  double rms_px = 0.0;
  std::vector<Residual> residuals;
  std::vector<std::string> views;     // used
  std::vector<double> view_rms_px;    // of each
  std::vector<double> tilt_rad;       // of each: board against the picture's plane
  std::vector<std::string> left_out;  // boards that fit no camera: blurred, bent, wrongly found
};

// At least 4 views. Views whose error is 3 times the median are left out, once. Errors: kMalformed saying what to do.
[[nodiscard]] Result<CameraCalibration> calibrate_camera(const std::vector<View>& views, int width_px, int height_px,
                                                         Distortion model);

// What else to take pictures of, each a sentence; empty: enough.
[[nodiscard]] std::vector<std::string> advice(const CameraCalibration& calibration);

// As Kalibr writes a camchain; edges/camera_file.hpp reads it back.
[[nodiscard]] std::string to_kalibr_yaml(const CameraCalibration& calibration);
// A page with residuals, coverage and figures. Errors: as of report::draw().
[[nodiscard]] Result<std::string> calibration_page(const CameraCalibration& calibration);

}  // namespace rfmvo::calibrate
