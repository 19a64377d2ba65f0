#include "vision/relocalisation.hpp"

#include <map>
#include <opencv2/features2d.hpp>
#include <vector>

#include "vision/corners.hpp"

namespace rfmvo {
namespace {

constexpr std::int64_t kKeyframes = 20;  // the newest: a second or two of the way
constexpr int kCorners = 600;            // of the picture: more than tracks, as a landmark need not be the best of its cell
constexpr float kPatch_px = 31.0F;       // ORB's
constexpr float kRatio = 0.8F;           // Lowe 2004: of the best distance to the second best
constexpr int kMinInliers = 15;
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

// Pairs (query, train) that are each other's best, and clearly so.
std::vector<cv::DMatch> clear_matches(const cv::Mat& query, const cv::Mat& train) {
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<std::vector<cv::DMatch>> there;
  std::vector<cv::DMatch> back, result;
  matcher.knnMatch(query, train, there, 2);
  matcher.match(train, query, back);
  for (const auto& pair : there) {
    if (pair.size() < 2 || pair[0].distance >= kRatio * pair[1].distance) continue;
    if (back[static_cast<std::size_t>(pair[0].trainIdx)].trainIdx == pair[0].queryIdx) result.push_back(pair[0]);
  }
  return result;
}

}  // namespace

std::optional<ViewPose> guess_pose(const Map& map, const Lens& lens, const cv::Mat& grey, const ViewPose& fallback,
                                   const MotionOptions& options) {
  std::vector<cv::KeyPoint> corners;
  for (const cv::Point2f& px : find_corners(grey, {}, kCorners, kCorners)) corners.push_back(upright(px, 0));
  if (corners.size() < kMinInliers) return std::nullopt;
  const Described here = describe(grey, std::move(corners));
  std::vector<const Landmark*> landmarks;
  const Described known = describe_map(map, landmarks);
  if (here.points.size() < kMinInliers || known.points.size() < kMinInliers) return std::nullopt;

  std::vector<MotionObservation> seen;
  for (const cv::DMatch& match : clear_matches(here.descriptors, known.descriptors)) {
    const cv::KeyPoint& point = known.points[static_cast<std::size_t>(match.trainIdx)];
    const cv::Point2f& px = here.points[static_cast<std::size_t>(match.queryIdx)].pt;
    const Eigen::Vector2d normalised = unproject(lens.camera(), {px.x, px.y});
    seen.push_back({landmarks[static_cast<std::size_t>(point.class_id)]->p_V, normalised,
                    image_scale(lens.camera(), normalised)});
  }
  if (seen.size() < kMinInliers) return std::nullopt;
  const MotionSolution s = solve_motion_globally(seen, fallback, options);
  const bool agreed = s.inliers >= kMinInliers && s.inliers >= kMinInlierShare * static_cast<double>(seen.size());
  return agreed ? std::optional(s.T_C_V) : std::nullopt;
}

}  // namespace rfmvo
