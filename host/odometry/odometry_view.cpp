#include "odometry/odometry_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <vector>

#include "evaluate/last_estimates.hpp"

namespace rfmvo::odometry {
namespace {

constexpr int kPaneWidth_px = 640, kPaneHeight_px = 480;
constexpr double kRate_hz = 30.0;  // of the film
constexpr std::size_t kTail = 8;   // frames of a point's way that are drawn
const cv::Scalar kGreen(80, 220, 80), kOrange(40, 160, 255), kRed(60, 60, 240), kGrey(150, 150, 150),
    kWhite(255, 255, 255), kBlue(255, 160, 60);

// V from above: x to the right, z (where the first camera looked) up.
struct Plan {
  double x0, z0, px_per_unit;
  [[nodiscard]] cv::Point at(const Eigen::Vector3d& p) const {
    const auto px = [this](double d) { return static_cast<int>(std::clamp(d * px_per_unit, -1e4, 1e4)); };
    return {kPaneWidth_px + kPaneWidth_px / 2 + px(p.x() - x0), kPaneHeight_px / 2 - px(p.z() - z0)};
  }
};

Plan plan_of(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> x, z;
  for (const auto& p : points) x.push_back(p.x()), z.push_back(p.z());
  std::sort(x.begin(), x.end());
  std::sort(z.begin(), z.end());
  const std::size_t low = x.size() / 50, high = x.size() - 1 - low;  // a few wild points must not shrink the rest
  const double width = std::max(x[high] - x[low], 0.1), height = std::max(z[high] - z[low], 0.1);
  return {0.5 * (x[low] + x[high]), 0.5 * (z[low] + z[high]),
          0.9 * std::min(kPaneWidth_px / width, kPaneHeight_px / height)};
}

}  // namespace

struct ViewWriter::Impl {
  std::string path, temporary;
  bool film = false, done = false;
  cv::VideoWriter video;
  cv::Mat canvas;
  std::map<std::int64_t, std::deque<cv::Point2f>> tails;
  std::uint32_t segment = 0;
  std::vector<Eigen::Vector3d> way, past_points;

  void draw_image(const Frame& frame, const OdometryView& view);
  void draw_map(const CameraPose& pose, const OdometryView& view);
};

void ViewWriter::Impl::draw_image(const Frame& frame, const OdometryView& view) {
  const cv::Mat grey(frame.height_px, frame.width_px, CV_8UC1, const_cast<std::uint8_t*>(frame.grey->data()));
  const double k = std::min(1.0 * kPaneWidth_px / grey.cols, 1.0 * kPaneHeight_px / grey.rows);
  cv::Mat colour, scaled;
  cv::resize(grey, scaled, {}, k, k, cv::INTER_AREA);
  cv::cvtColor(scaled, colour, cv::COLOR_GRAY2BGR);
  canvas = cv::Mat(kPaneHeight_px, 2 * kPaneWidth_px, CV_8UC3, cv::Scalar(30, 30, 30));
  std::map<std::int64_t, std::deque<cv::Point2f>> kept;
  for (const OdometryView::Point& point : view.tracks) {
    const cv::Point2f at(static_cast<float>(k * point.px.x()), static_cast<float>(k * point.px.y()));
    auto& tail = kept[point.landmark];
    tail.swap(tails[point.landmark]);
    tail.push_back(at);
    if (tail.size() > kTail) tail.pop_front();
    const cv::Scalar colour_of = !point.located ? kOrange : point.fits ? kGreen : kRed;
    for (std::size_t i = 1; i < tail.size(); ++i) cv::line(colour, tail[i - 1], tail[i], colour_of, 1, cv::LINE_AA);
    cv::circle(colour, at, 2, colour_of, -1, cv::LINE_AA);
  }
  tails.swap(kept);
  colour.copyTo(canvas(cv::Rect(0, 0, colour.cols, colour.rows)));
}

void ViewWriter::Impl::draw_map(const CameraPose& pose, const OdometryView& view) {
  if (pose.segment != segment) {
    way.clear();
    past_points.clear();
  }
  segment = pose.segment;
  const bool has_pose = pose.status == VoStatus::kTracking || pose.status == VoStatus::kDegraded;
  if (has_pose) way.push_back(pose.T_V_C.p_V_C);
  std::vector<Eigen::Vector3d> all = way;
  all.insert(all.end(), view.points_V.begin(), view.points_V.end());
  if (!all.empty()) {
    const Plan plan = plan_of(all);
    const cv::Rect pane(kPaneWidth_px, 0, kPaneWidth_px, kPaneHeight_px);
    const auto dot = [&](const Eigen::Vector3d& p, const cv::Scalar& colour, int radius) {
      if (const cv::Point at = plan.at(p); pane.contains(at)) cv::circle(canvas, at, radius, colour, -1, cv::LINE_AA);
    };
    for (const auto& p : view.points_V) dot(p, kGrey, 1);
    for (std::size_t i = 1; i < way.size(); ++i) {
      cv::line(canvas, plan.at(way[i - 1]), plan.at(way[i]), kGreen, 1, cv::LINE_AA);
    }
    for (const auto& p : view.keyframes_V) dot(p, kBlue, 3);
    if (has_pose) {
      dot(pose.T_V_C.p_V_C, kWhite, 4);
      const Eigen::Vector3d ahead = pose.T_V_C.p_V_C + pose.T_V_C.R_V_C * Eigen::Vector3d(0, 0, 20 / plan.px_per_unit);
      cv::line(canvas, plan.at(pose.T_V_C.p_V_C), plan.at(ahead), kWhite, 2, cv::LINE_AA);
    }
  }
  cv::putText(canvas, fmt::format("{}  segment {}  {} inliers", evaluate::label_of(pose.status), pose.segment, pose.inliers),
              {kPaneWidth_px + 12, 24}, cv::FONT_HERSHEY_SIMPLEX, 0.55, kWhite, 1, cv::LINE_AA);
}

ViewWriter::ViewWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

ViewWriter::~ViewWriter() {
  if (impl_->done || !impl_->film) return;
  impl_->video.release();
  std::error_code ignored;
  std::filesystem::remove(impl_->temporary, ignored);
}

Result<std::unique_ptr<ViewWriter>> ViewWriter::create(const std::string& path) {
  const std::filesystem::path file(path);
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  impl->film = file.extension() == ".mp4";
  if (!impl->film && file.extension() != ".png")
    return Error{ErrorCode::kUnsupported, "a view is a .mp4 or a .png", path};
  // The library tells formats by the last extension.
  impl->temporary = (file.parent_path() / (file.stem().string() + ".tmp" + file.extension().string())).string();
  if (impl->film && !impl->video.open(impl->temporary, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), kRate_hz,
                                      {2 * kPaneWidth_px, kPaneHeight_px}))
    return Error{ErrorCode::kUnwritable, "cannot be written", path};
  return std::unique_ptr<ViewWriter>(new ViewWriter(std::move(impl)));
}

Status ViewWriter::add(const Frame& frame, const CameraPose& pose, const VisualOdometry& odometry) {
  const OdometryView view = odometry.view();
  impl_->draw_image(frame, view);
  impl_->draw_map(pose, view);
  if (impl_->film) impl_->video.write(impl_->canvas);
  return Done{};
}

Status ViewWriter::close() {
  if (impl_->film) {
    impl_->video.release();
  } else if (impl_->canvas.empty() || !cv::imwrite(impl_->temporary, impl_->canvas)) {
    return Error{ErrorCode::kUnwritable, "cannot be written", impl_->path};
  }
  impl_->done = true;
  std::error_code failure;
  std::filesystem::rename(impl_->temporary, impl_->path, failure);
  if (failure) return Error{ErrorCode::kUnwritable, failure.message(), impl_->path};
  return Done{};
}

}  // namespace rfmvo::odometry
