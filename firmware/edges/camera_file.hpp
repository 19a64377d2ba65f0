// Camera calibrations as other tools write them: Kalibr's camchain, OpenCV's YAML, ROS's camera_info.
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"
#include "geometry/camera_model.hpp"

namespace rfmvo {

// Recognised by their keys:
//   Kalibr: cam0: {camera_model: pinhole, intrinsics: [fx, fy, cx, cy], distortion_model: radtan | equidistant | none,
//           distortion_coeffs: [..], resolution: [w, h]}; the first camera of a chain is taken;
//   OpenCV: %YAML:1.0, camera_matrix (or K, cameraMatrix), distortion_coefficients (or D, distCoeffs), image_width,
//           image_height; fisheye_model or distortion_model: fisheye | equidistant mean a fisheye lens;
//   ROS:    sensor_msgs/CameraInfo, as camera_calibration writes it or as a printed message (K, D, width, height);
//           distortion_model: plumb_bob | equidistant.
// Errors: kMalformed naming what is missing or not finite; kUnsupported for other models (omni, rational with
// coefficients beyond the fifth that are not zero).
[[nodiscard]] Result<CameraModel> parse_camera_yaml(std::string_view yaml, const std::string& where);

// By the name: .yaml, .yml (above); .toml (rfmvo's own calibration); .txt (calib.txt of image folders).
[[nodiscard]] Result<CameraModel> read_camera_file(const std::string& path);

}  // namespace rfmvo
