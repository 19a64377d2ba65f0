#include "vision/relocalisation.hpp"

#include <cmath>
#include <map>
#include <opencv2/features2d.hpp>
#include <vector>

#include "vision/corners.hpp"
#include "vision/reprojection.hpp"

namespace rfmvo {
namespace {

constexpr std::int64_t kKeyframes = 20;  // the newest: a second or two of the way
constexpr int kCorners = 600;       // of the picture: more than tracks, as a landmark need not be the best of its cell
constexpr float kPatch_px = 31.0F;  // ORB's
constexpr float kRatio = 0.8F;      // Lowe 2004: of the best distance to the second best
constexpr float kMostDistance = 64.0F;  // bits of 256: beyond, a match is chance
constexpr double kRadius = 0.12;        // of the picture's width: what a swing of the speed makes of the prediction
constexpr double kWidest = 1.5;         // of the normalised plane: radtan folds over beyond
constexpr std::size_t kMinInliers = 15;
constexpr double kMinInlierShare = 0.3;  // of the matches: random ones agree on far fewer

struct Described {
  std::vector<cv::KeyPoint> points;  // class_id: index of the caller's
  cv::Mat descriptors;
};

Described describe(const cv::Mat& grey, std::vector<cv::KeyPoint> points) {
  // One level, no turn: within a gap neither distance nor roll changes much, and upright descriptors tell more apart.
  const auto orb = cv::ORB::create(kCorners, 1.2F, 1);
  Described d;
  d.points = std::move(points);
  orb->compute(grey, d.points, d.descriptors);
  return d;
}

cv::KeyPoint upright(const cv::Point2f& px, int index) { return {px, kPatch_px, 0.0F, 1.0F, 0, index}; }

// Each landmark as its newest key frame shows it.
Described describe_map(const Map& map, std::vector<const Landmark*>& landmarks) {
  const std::int64_t oldest = map.keyframes.back().id - kKeyframes;
  std::map<std::int64_t, std::vector<cv::KeyPoint>> by_keyframe;
  for (const auto& [id, landmark] : map.landmarks) {
    if (!landmark.located || landmark.observations.empty()) continue;
    const KeyframeObservation& o = landmark.observations.back();
    if (o.keyframe < oldest) continue;
    by_keyframe[o.keyframe].push_back(upright(o.px, static_cast<int>(landmarks.size())));
    landmarks.push_back(&landmark);
  }
  Described all;
  for (auto& [id, points] : by_keyframe) {
    const Described d = describe(map.find(id)->pyramid[0], std::move(points));
    all.points.insert(all.points.end(), d.points.begin(), d.points.end());
    if (!d.descriptors.empty()) all.descriptors.push_back(d.descriptors);
  }
  return all;
}

// Pairs (landmark, corner) that are each other's best among those that `mask` allows (empty: all), and clearly so.
std::vector<cv::DMatch> clear_matches(const cv::Mat& landmarks, const cv::Mat& corners, const cv::Mat& mask) {
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<std::vector<cv::DMatch>> there;
  std::vector<std::vector<cv::DMatch>> back;
  matcher.knnMatch(landmarks, corners, there, 2, mask);
  matcher.knnMatch(corners, landmarks, back, 1, mask.empty() ? mask : cv::Mat(mask.t()));
  std::vector<int> best(static_cast<std::size_t>(corners.rows), -1);
  for (const auto& one : back) {
    if (!one.empty()) best[static_cast<std::size_t>(one[0].queryIdx)] = one[0].trainIdx;
  }
  std::vector<cv::DMatch> result;
  for (const auto& pair : there) {
    if (pair.empty() || pair[0].distance > kMostDistance) continue;
    if (pair.size() > 1 && pair[0].distance >= kRatio * pair[1].distance) continue;
    if (best[static_cast<std::size_t>(pair[0].trainIdx)] == pair[0].queryIdx) result.push_back(pair[0]);
  }
  return result;
}

// Which corners are near enough to where the predicted pose has a landmark.
cv::Mat near_prediction(const Described& known, const std::vector<const Landmark*>& landmarks, const Described& here,
                        const CameraModel& camera, const ViewPose& predicted) {
  cv::Mat mask(static_cast<int>(known.points.size()), static_cast<int>(here.points.size()), CV_8UC1, cv::Scalar(0));
  const double radius_px = kRadius * camera.width_px;
  for (int row = 0; row < mask.rows; ++row) {
    const Eigen::Vector3d p_C =
        predicted * landmarks[static_cast<std::size_t>(known.points[static_cast<std::size_t>(row)].class_id)]->p_V;
    if (p_C.z() <= kMinDepth || p_C.hnormalized().norm() > kWidest) continue;
    const Eigen::Vector2d px = project(camera, p_C.hnormalized());
    for (int column = 0; column < mask.cols; ++column) {
      const cv::Point2f& corner = here.points[static_cast<std::size_t>(column)].pt;
      if (std::hypot(corner.x - px.x(), corner.y - px.y()) < radius_px) mask.at<std::uint8_t>(row, column) = 1;
    }
  }
  return mask;
}

}  // namespace

std::optional<ViewPose> guess_pose(const Map& map, const Lens& lens, const cv::Mat& grey, const ViewPose& predicted,
                                   const MotionOptions& options) {
  std::vector<cv::KeyPoint> corners;
  for (const cv::Point2f& px : find_corners(grey, {}, kCorners, kCorners)) corners.push_back(upright(px, 0));
  if (corners.size() < kMinInliers) return std::nullopt;
  const Described here = describe(grey, std::move(corners));
  std::vector<const Landmark*> landmarks;
  const Described known = describe_map(map, landmarks);
  if (here.points.size() < kMinInliers || known.points.size() < kMinInliers) return std::nullopt;

  for (const cv::Mat& mask : {near_prediction(known, landmarks, here, lens.camera(), predicted), cv::Mat()}) {
    std::vector<MotionObservation> seen;
    for (const cv::DMatch& match : clear_matches(known.descriptors, here.descriptors, mask)) {
      const cv::KeyPoint& point = known.points[static_cast<std::size_t>(match.queryIdx)];
      const cv::Point2f& px = here.points[static_cast<std::size_t>(match.trainIdx)].pt;
      const Eigen::Vector2d normalised = unproject(lens.camera(), {px.x, px.y});
      seen.push_back({landmarks[static_cast<std::size_t>(point.class_id)]->p_V, normalised,
                      image_scale(lens.camera(), normalised)});
    }
    if (seen.size() < kMinInliers) continue;
    const MotionSolution s = solve_motion_globally(seen, predicted, options);
    if (s.inliers >= static_cast<int>(kMinInliers) && s.inliers >= kMinInlierShare * static_cast<double>(seen.size()))
      return s.T_C_V;
  }
  return std::nullopt;
}

}  // namespace rfmvo
