#include "calibrate/camera_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace rfmvo::calibrate {
namespace {

constexpr std::size_t kMinViews = 4;
constexpr double kLeftOutFactor = 3.0;

struct Solution {
  cv::Mat K = cv::Mat::eye(3, 3, CV_64F), D;
  std::vector<cv::Mat> rotations, translations;
  cv::Mat sigmas;
  double rms_px = 0.0;
};

std::vector<std::vector<cv::Point3d>> board_points(const std::vector<View>& views) {
  std::vector<std::vector<cv::Point3d>> all;
  for (const View& view : views) {
    auto& points = all.emplace_back();
    for (const Point2& p : view.board_m) points.emplace_back(p.x, p.y, 0.0);
  }
  return all;
}

std::vector<std::vector<cv::Point2d>> image_points(const std::vector<View>& views) {
  std::vector<std::vector<cv::Point2d>> all;
  for (const View& view : views) {
    auto& points = all.emplace_back();
    for (const Point2& p : view.image_px) points.emplace_back(p.x, p.y);
  }
  return all;
}

// OpenCV's interface to the pinhole model takes single precision only.
template <class To, class From>
std::vector<std::vector<To>> single(const std::vector<std::vector<From>>& all) {
  std::vector<std::vector<To>> out;
  for (const auto& points : all) out.emplace_back(points.begin(), points.end());
  return out;
}

Solution solve_radtan(const std::vector<View>& views, cv::Size size) {
  Solution s;
  cv::Mat extrinsic_sigmas, view_errors;
  s.D = cv::Mat::zeros(5, 1, CV_64F);
  s.rms_px = cv::calibrateCamera(single<cv::Point3f>(board_points(views)), single<cv::Point2f>(image_points(views)),
                                 size, s.K, s.D, s.rotations, s.translations, s.sigmas, extrinsic_sigmas, view_errors,
                                 cv::CALIB_FIX_K3);  // k1 k2 p1 p2, as Kalibr's radtan
  return s;
}

Solution solve_equidistant(const std::vector<View>& views, cv::Size size) {
  Solution s;
  s.D = cv::Mat::zeros(4, 1, CV_64F);
  s.rms_px =
      cv::fisheye::calibrate(board_points(views), image_points(views), size, s.K, s.D, s.rotations, s.translations,
                             cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW,
                             {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-10});
  return s;
}

std::vector<cv::Point2d> predicted(const Solution& s, const View& view, std::size_t index, Distortion model) {
  const auto board = board_points({view}).front();
  std::vector<cv::Point2d> image;
  if (model == Distortion::kEquidistant)
    cv::fisheye::projectPoints(board, image, s.rotations[index], s.translations[index], s.K, s.D);
  else
    cv::projectPoints(board, s.rotations[index], s.translations[index], s.K, s.D, image);
  return image;
}

double tilt_of(const cv::Mat& rotation_vector) {
  cv::Matx33d R;
  cv::Rodrigues(rotation_vector, R);
  return std::acos(std::clamp(std::abs(R(2, 2)), 0.0, 1.0));
}

CameraModel model_of(const Solution& s, cv::Size size, Distortion model) {
  CameraModel camera;
  camera.width_px = size.width;
  camera.height_px = size.height;
  camera.fx_px = s.K.at<double>(0, 0);
  camera.fy_px = s.K.at<double>(1, 1);
  camera.cx_px = s.K.at<double>(0, 2);
  camera.cy_px = s.K.at<double>(1, 2);
  camera.distortion = model;
  for (int i = 0; i < 4; ++i) {
    auto& k = model == Distortion::kEquidistant ? camera.equidistant[static_cast<std::size_t>(i)]
                                                : camera.radtan[static_cast<std::size_t>(i)];
    k = s.D.at<double>(i);
  }
  return camera;
}

CameraCalibration figures_of(const Solution& s, const std::vector<View>& views, cv::Size size, Distortion model) {
  CameraCalibration c;
  c.camera = model_of(s, size, model);
  double squares = 0.0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto image = predicted(s, views[v], v, model);
    double view_squares = 0.0;
    for (std::size_t i = 0; i < image.size(); ++i) {
      const Point2& seen = views[v].image_px[i];
      const Point2 error{seen.x - image[i].x, seen.y - image[i].y};
      view_squares += error.x * error.x + error.y * error.y;
      c.residuals.push_back({seen, error, v});
    }
    squares += view_squares;
    c.views.push_back(views[v].name);
    c.view_rms_px.push_back(std::sqrt(view_squares / static_cast<double>(image.size())));
    c.tilt_rad.push_back(tilt_of(s.rotations[v]));
  }
  c.rms_px = std::sqrt(squares / static_cast<double>(c.residuals.size()));
  if (s.sigmas.total() >= 4) {  // fx, fy, cx, cy come first
    c.focal_sigma_px = std::max(s.sigmas.at<double>(0), s.sigmas.at<double>(1));
    c.centre_sigma_px = std::max(s.sigmas.at<double>(2), s.sigmas.at<double>(3));
  }
  return c;
}

Result<CameraCalibration> solve(const std::vector<View>& views, cv::Size size, Distortion model) {
  try {
    const Solution s = model == Distortion::kEquidistant ? solve_equidistant(views, size) : solve_radtan(views, size);
    CameraCalibration c = figures_of(s, views, size, model);
    const bool sane = std::isfinite(c.rms_px) && c.camera.fx_px > 0.0 && c.camera.fy_px > 0.0;
    if (sane) return c;
  } catch (const cv::Exception&) {
    // said below
  }
  return Error{ErrorCode::kMalformed,
               "no camera fits these pictures: take some with the board tilted by 30 degrees, and "
               "check its columns and rows",
               ""};
}

}  // namespace

Result<CameraCalibration> calibrate_camera(const std::vector<View>& views, int width_px, int height_px,
                                           Distortion model) {
  if (views.size() < kMinViews)
    return Error{ErrorCode::kMalformed,
                 "the board was found in " + std::to_string(views.size()) + " pictures; " + std::to_string(kMinViews) +
                     " are the least, 20 are good",
                 ""};
  const cv::Size size(width_px, height_px);
  auto first = solve(views, size, model);
  if (!first) return first.error();
  std::vector<double> sorted = first.value().view_rms_px;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double limit = kLeftOutFactor * sorted[sorted.size() / 2];
  std::vector<View> kept;
  std::vector<std::string> left_out;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (first.value().view_rms_px[v] <= limit)
      kept.push_back(views[v]);
    else
      left_out.push_back(views[v].name);
  }
  if (left_out.empty() || kept.size() < kMinViews) return first;
  auto second = solve(kept, size, model);
  if (!second) return first;
  CameraCalibration calibration = std::move(second).value();
  calibration.left_out = std::move(left_out);
  return calibration;
}

}  // namespace rfmvo::calibrate
