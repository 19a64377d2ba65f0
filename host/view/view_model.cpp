#include "view/view_model.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "edges/lcm_codec.hpp"
#include "evaluate/last_estimates.hpp"
#include "rf/epc_uri.hpp"
#include "view/image_overlay.hpp"

namespace rfmvo::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxPathPoints = 2000;  // more cannot be seen
constexpr std::size_t kMaxOverlayTags = 300;

double rounded(double x, double step) { return std::round(x / step) * step; }
Json place(const Eigen::Vector3d& p) {
  return Json::array({rounded(p.x(), 1e-3), rounded(p.y(), 1e-3), rounded(p.z(), 1e-3)});
}

// Upper triangle: what the page needs for an ellipse from above.
Json plane_covariance(const Eigen::Matrix3d& c) { return Json::array({c(0, 0), c(0, 1), c(1, 1)}); }

Json map_tag(const TagEstimate& tag) {
  Json json{{"epc", tag.epc.hex()}, {"status", evaluate::label_of(tag.status)}, {"reads", tag.reads}};
  if (const auto uri = epc_tag_uri(tag.epc)) json["uri"] = *uri;
  if (!evaluate::is_located(tag)) return json;
  json["p"] = place(tag.p_W_X_m);
  json["s"] = place(evaluate::sigma_of(tag.covariance_m2));
  json["c"] = plane_covariance(tag.covariance_m2);
  for (std::size_t i = 1; i < tag.hypotheses.size(); ++i) json["other"].push_back(place(tag.hypotheses[i].p_W_X_m));
  return json;
}

Json overlay_tag(const TagEstimate& tag, const ImageEllipse& e) {
  return {{"epc", tag.epc.hex()},
          {"ok", tag.status == TagStatus::kConverged},
          {"x", rounded(e.centre_px.x(), 0.1)},
          {"y", rounded(e.centre_px.y(), 0.1)},
          {"a", rounded(e.major_px, 0.1)},
          {"b", rounded(e.minor_px, 0.1)},
          {"angle", rounded(e.angle_rad, 1e-3)},
          {"d", rounded(e.distance_m, 0.01)}};
}

}  // namespace

void ViewModel::on(const BusMessage& message, std::int64_t now_ns) {
  status_.on(message, now_ns);
  if (is_event_channel(message.channel, prefix_)) {
    if (const auto event = decode_event(message.channel, message.data, prefix_)) on_event(event.value());
  } else if (is_estimate_channel(message.channel, prefix_)) {
    if (const auto estimate = decode_estimate(message.channel, message.data, prefix_)) on_estimate(estimate.value());
  }
}

void ViewModel::on_event(const Event& event) {
  if (const auto* start = std::get_if<Start>(&event)) {
    if (!start_ || start_->time != start->time) paths_.clear();
    start_ = *start;
    ++map_version_, ++overlay_version_;
  }
  if (const auto* frame = std::get_if<Frame>(&event)) {
    frame_ = *frame;
    ++picture_version_, ++overlay_version_;
  }
}

void ViewModel::on_estimate(const Estimate& estimate) {
  if (const auto* trajectory = std::get_if<Trajectory>(&estimate)) {
    paths_.insert_or_assign(trajectory->segment, *trajectory);
    ++map_version_;
  }
  if (std::holds_alternative<TagEstimate>(estimate)) ++map_version_, ++overlay_version_;
  if (std::holds_alternative<MetricPose>(estimate)) ++overlay_version_;
}

std::string ViewModel::picture() const {
  if (!frame_) return "";
  if (frame_->encoded != nullptr)
    return {reinterpret_cast<const char*>(frame_->encoded->data()), frame_->encoded->size()};
  const cv::Mat grey(frame_->height_px, frame_->width_px, CV_8UC1, const_cast<std::uint8_t*>(frame_->grey->data()));
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".jpg", grey, bytes)) return "";
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::optional<Rigid3> ViewModel::camera_pose() const {
  constexpr Duration kNear{50'000'000};
  const auto& said = status_.pose();
  if (!frame_ && !said) return std::nullopt;
  const DeviceTime time = frame_ ? frame_->time : said->time;
  for (const auto& [segment, path] : paths_) {
    const auto after = std::lower_bound(path.poses.begin(), path.poses.end(), time,
                                        [](const MetricPose& pose, DeviceTime t) { return pose.time < t; });
    if (after != path.poses.end() && after->time - time <= kNear) return after->T_W_C;
  }
  return said ? std::optional(said->T_W_C) : std::nullopt;
}

std::string ViewModel::overlay() const {
  Json json{{"type", "overlay"}, {"tags", Json::array()}};
  const auto pose = camera_pose();
  if (pose) {
    const Eigen::Vector3d ahead = pose->R * Eigen::Vector3d::UnitZ();
    json["camera"] = {{"p", place(pose->t)}, {"ahead", Json::array({ahead.x(), ahead.y()})}};
  }
  if (!start_) return json.dump();
  const CameraModel& camera = start_->calibration.camera;
  json["width"] = camera.width_px;
  json["height"] = camera.height_px;
  if (!pose) return json.dump();
  for (const auto& [epc, tag] : status_.tags()) {
    if (!evaluate::is_located(tag) || json["tags"].size() >= kMaxOverlayTags) continue;
    if (const auto ellipse = in_picture(camera, *pose, tag.p_W_X_m, tag.covariance_m2))
      json["tags"].push_back(overlay_tag(tag, *ellipse));
  }
  return json.dump();
}

std::string ViewModel::map() const {
  Json json{{"type", "map"}, {"paths", Json::array()}, {"tags", Json::array()}};
  for (const auto& [segment, trajectory] : paths_) {
    Json points = Json::array();
    const std::size_t step = trajectory.poses.size() / kMaxPathPoints + 1;
    for (std::size_t i = 0; i < trajectory.poses.size(); i += step) {
      const Eigen::Vector3d& p = trajectory.poses[i].T_W_C.t;
      points.push_back(Json::array({rounded(p.x(), 1e-3), rounded(p.y(), 1e-3)}));
    }
    json["paths"].push_back(std::move(points));
  }
  for (const auto& [epc, tag] : status_.tags()) json["tags"].push_back(map_tag(tag));
  return json.dump();
}

std::string ViewModel::status(const status::View& view) const {
  return "{\"type\":\"status\",\"line\":" + Json(status::to_line(status_, view)).dump() +
         ",\"box\":" + status::to_json(status_, view) + "}";
}

}  // namespace rfmvo::view
