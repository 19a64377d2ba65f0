#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/units.hpp"
#include "calibrate/camera_calibration.hpp"

namespace rfmvo::calibrate {
namespace {

// Distortion is known where corners were; it grows towards the edges, so these count.
constexpr int kColumns = 3, kRows = 3;
constexpr std::array<const char*, 9> kPlaces = {"upper left", "top",        "upper right", "left",       "middle",
                                                "right",      "lower left", "bottom",      "lower right"};
constexpr std::size_t kGoodViews = 15, kMinCornersPerPlace = 20;
constexpr double kGoodTilt_deg = 20.0;
constexpr std::size_t kTiltedViews = 4;
constexpr double kGoodRms_px = 0.5;
constexpr double kGoodFocal = 0.005;  // 1 sigma, of the focal length

std::string empty_places(const CameraCalibration& c) {
  std::array<std::size_t, 9> counts{};
  for (const Residual& r : c.residuals) {
    const int column = std::clamp(static_cast<int>(r.at_px.x * kColumns / c.camera.width_px), 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(r.at_px.y * kRows / c.camera.height_px), 0, kRows - 1);
    ++counts[static_cast<std::size_t>(row * kColumns + column)];
  }
  std::string places;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] < kMinCornersPerPlace) places += (places.empty() ? "" : ", ") + std::string(kPlaces[i]);
  return places;
}

}  // namespace

std::vector<std::string> advice(const CameraCalibration& c) {
  std::vector<std::string> sentences;
  if (c.views.size() < kGoodViews)
    sentences.push_back(fmt::format("only {} pictures: take {} or more", c.views.size(), kGoodViews));
  if (const std::string places = empty_places(c); !places.empty())
    sentences.push_back("too few corners in parts of the picture: bring the board there: " + places);
  const auto tilted = std::count_if(c.tilt_rad.begin(), c.tilt_rad.end(),
                                    [](double tilt) { return tilt > rad_from_deg(kGoodTilt_deg); });
  if (static_cast<std::size_t>(tilted) < kTiltedViews)
    sentences.push_back(
        fmt::format("the board faces the camera in nearly all pictures: tilt it by 20 to 45 degrees, about both axes, "
                    "in {} or more; "
                    "otherwise focal length and distance are one unknown",
                    kTiltedViews));
  if (c.focal_sigma_px > kGoodFocal * c.camera.fx_px)
    sentences.push_back(fmt::format("the focal length is known to {:.1f} % only: more pictures, nearer and tilted",
                                    100.0 * c.focal_sigma_px / c.camera.fx_px));
  if (c.rms_px > kGoodRms_px)
    sentences.push_back(
        fmt::format("the error of {:.2f} px is large: a flat board, sharp pictures, no motion", c.rms_px));
  if (!c.left_out.empty())
    sentences.push_back(fmt::format("left out, because they fit no camera: {}", fmt::join(c.left_out, ", ")));
  return sentences;
}

std::string to_kalibr_yaml(const CameraCalibration& c) {
  const CameraModel& m = c.camera;
  const bool fisheye = m.distortion == Distortion::kEquidistant;
  const auto k = [&](std::size_t i) { return fisheye ? m.equidistant[i] : m.radtan[i]; };
  return fmt::format(
      "# {} pictures of a board, {} corners, error {:.3f} px RMS\n"
      "cam0:\n  camera_model: pinhole\n  intrinsics: [{}, {}, {}, {}]\n  distortion_model: {}\n"
      "  distortion_coeffs: [{}, {}, {}, {}]\n  resolution: [{}, {}]\n",
      c.views.size(), c.residuals.size(), c.rms_px, m.fx_px, m.fy_px, m.cx_px, m.cy_px,
      fisheye ? "equidistant" : "radtan", k(0), k(1), k(2), k(3), m.width_px, m.height_px);
}

}  // namespace rfmvo::calibrate
