#include "mcap/foxglove_messages.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "evaluate/last_estimates.hpp"
#include "rf/epc_uri.hpp"

namespace rfmvo::mcap {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;
constexpr double kChi2_95_3dof = 7.814727903251179;  // 95 % of chi-square, 3 degrees of freedom
constexpr double kSmallest_m = 0.01;                 // a sphere that can be seen

struct Colour {
  double r, g, b, a;
};
constexpr Colour kConverged{0.09, 0.41, 0.78, 0.6}, kDoubt{0.79, 0.42, 0.0, 0.5}, kOther{0.79, 0.42, 0.0, 0.2},
    kPath{0.54, 0.58, 0.64, 1.0}, kInk{0.1, 0.14, 0.19, 1.0};

Json json_of(DeviceTime time) {
  const std::int64_t ns = std::max<std::int64_t>(time.ns, 0);
  return {{"sec", ns / kNsPerS}, {"nsec", ns % kNsPerS}};
}
Json json_of(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }
Json json_of(const Eigen::Quaterniond& q) { return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}; }
Json json_of(const Colour& c) { return {{"r", c.r}, {"g", c.g}, {"b", c.b}, {"a", c.a}}; }
Json pose_of(const Eigen::Vector3d& p, const Eigen::Quaterniond& q = Eigen::Quaterniond::Identity()) {
  return {{"position", json_of(p)}, {"orientation", json_of(q)}};
}

Json sphere(const Eigen::Vector3d& p, const Eigen::Matrix3d& covariance, const Colour& colour) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;  // a rotation, not a reflection
  const Eigen::Vector3d size =
      2.0 * (kChi2_95_3dof * solver.eigenvalues().cwiseMax(0.0)).cwiseSqrt().cwiseMax(0.5 * kSmallest_m);
  return {
      {"pose", pose_of(p, Eigen::Quaterniond(axes).normalized())}, {"size", json_of(size)}, {"color", json_of(colour)}};
}

Json entity(DeviceTime time, const std::string& id) {
  Json json{
      {"timestamp", json_of(time)}, {"frame_id", "map"},        {"id", id}, {"lifetime", {{"sec", 0}, {"nsec", 0}}},
      {"frame_locked", false},      {"metadata", Json::array()}};
  for (const char* primitives : {"arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"})
    json[primitives] = Json::array();
  return json;
}

Json update(Json entity_json) {
  return {{"deletions", Json::array()}, {"entities", Json::array({std::move(entity_json)})}};
}

void add_metadata(Json& to, const char* key, const std::string& value) {
  to["metadata"].push_back({{"key", key}, {"value", value}});
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3), '\0');  // the NUL behind it has room in a std::string
  ::EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(), static_cast<int>(bytes.size()));
  return text;
}

}  // namespace

Json frame_transform(const MetricPose& pose) {
  return {{"timestamp", json_of(pose.time)},
          {"parent_frame_id", "map"},
          {"child_frame_id", "camera"},
          {"translation", json_of(pose.T_W_C.t)},
          {"rotation", json_of(pose.T_W_C.R)}};
}

Json scene_update(const TagEstimate& tag) {
  const std::string id = tag.epc.hex();
  if (!evaluate::is_located(tag)) {
    const Json deletion{{"timestamp", json_of(tag.time)}, {"type", 0}, {"id", id}};  // 0: that id
    return {{"deletions", Json::array({deletion})}, {"entities", Json::array()}};
  }
  Json json = entity(tag.time, id);
  json["spheres"].push_back(
      sphere(tag.p_W_X_m, tag.covariance_m2, tag.status == TagStatus::kConverged ? kConverged : kDoubt));
  for (std::size_t i = 1; i < tag.hypotheses.size(); ++i)
    json["spheres"].push_back(sphere(tag.hypotheses[i].p_W_X_m, tag.hypotheses[i].covariance_m2, kOther));
  const Eigen::Vector3d sigma = evaluate::sigma_of(tag.covariance_m2);
  json["texts"].push_back({{"pose", pose_of(tag.p_W_X_m + Eigen::Vector3d(0, 0, 0.1))},
                           {"billboard", true},
                           {"font_size", 12.0},
                           {"scale_invariant", true},
                           {"color", json_of(kInk)},
                           {"text", id.substr(id.size() > 6 ? id.size() - 6 : 0)}});
  add_metadata(json, "epc", id);
  if (const auto uri = epc_tag_uri(tag.epc)) add_metadata(json, "uri", *uri);
  add_metadata(json, "status", evaluate::label_of(tag.status));
  add_metadata(json, "sigma_m", fmt::format("{:.3f} {:.3f} {:.3f}", sigma.x(), sigma.y(), sigma.z()));
  add_metadata(json, "reads", std::to_string(tag.reads));
  return update(std::move(json));
}

Json scene_update(const Trajectory& trajectory) {
  Json json = entity(trajectory.time, "path " + std::to_string(trajectory.segment));
  Json points = Json::array();
  for (const MetricPose& pose : trajectory.poses) points.push_back(json_of(pose.T_W_C.t));
  json["lines"].push_back({{"type", 0},  // a strip
                           {"pose", pose_of(Eigen::Vector3d::Zero())},
                           {"thickness", 2.0},
                           {"scale_invariant", true},
                           {"points", points},
                           {"color", json_of(kPath)},
                           {"colors", Json::array()},
                           {"indices", Json::array()}});
  add_metadata(json, "map_revision", std::to_string(trajectory.map_revision));
  return update(std::move(json));
}

Json compressed_image(const Frame& frame) {
  std::vector<std::uint8_t> bytes;
  std::string format = frame.encoding;
  if (frame.encoded != nullptr) {
    bytes = *frame.encoded;
  } else if (frame.grey != nullptr) {
    const cv::Mat grey(frame.height_px, frame.width_px, CV_8UC1, const_cast<std::uint8_t*>(frame.grey->data()));
    if (!cv::imencode(".png", grey, bytes)) return nullptr;
    format = "png";
  } else {
    return nullptr;
  }
  return {{"timestamp", json_of(frame.time)}, {"frame_id", "camera"}, {"data", base64(bytes)}, {"format", format}};
}

Json camera_calibration(const CameraModel& c, DeviceTime time) {
  const bool fisheye = c.distortion == Distortion::kEquidistant;
  return {{"timestamp", json_of(time)},
          {"frame_id", "camera"},
          {"width", c.width_px},
          {"height", c.height_px},
          {"distortion_model", fisheye ? "equidistant" : "plumb_bob"},
          {"D", fisheye ? Json(c.equidistant) : Json(c.radtan)},
          {"K", {c.fx_px, 0.0, c.cx_px, 0.0, c.fy_px, c.cy_px, 0.0, 0.0, 1.0}},
          {"R", {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}},
          {"P", {c.fx_px, 0.0, c.cx_px, 0.0, 0.0, c.fy_px, c.cy_px, 0.0, 0.0, 0.0, 1.0, 0.0}}};
}

Json log_message(DeviceTime time, LogLevel level, const std::string& name, const std::string& message) {
  return {{"timestamp", json_of(time)},
          {"level", static_cast<int>(level)},
          {"message", message},
          {"name", name},
          {"file", ""},
          {"line", 0}};
}

}  // namespace rfmvo::mcap
