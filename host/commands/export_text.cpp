#include "commands/export_text.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>

#include "rf/epc_uri.hpp"

namespace rfmvo {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;

// Exact: a double does not hold nanoseconds since 1970.
std::string seconds_of(DeviceTime time) {
  std::int64_t s = time.ns / kNsPerS;
  std::int64_t ns = time.ns % kNsPerS;
  const bool negative = time.ns < 0;
  if (negative) {
    s = -s;
    ns = -ns;
  }
  return fmt::format("{}{}.{:09}", negative ? "-" : "", s, ns);
}

}  // namespace

std::string to_tum(const evaluate::LastEstimates& last) {
  std::string text;
  for (const auto& [segment, trajectory] : last.trajectories) {
    for (const MetricPose& pose : trajectory.poses) {
      const Eigen::Vector3d& t = pose.T_W_C.t;
      const Eigen::Quaterniond& q = pose.T_W_C.R;
      fmt::format_to(std::back_inserter(text), "{} {:.9f} {:.9f} {:.9f} {:.12f} {:.12f} {:.12f} {:.12f}\n",
                     seconds_of(pose.time), t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    }
  }
  return text;
}

std::string to_tags_csv(const evaluate::LastEstimates& last) {
  std::string text =
      "epc,status,x_m,y_m,z_m,cov_xx_m2,cov_xy_m2,cov_xz_m2,cov_yy_m2,cov_yz_m2,cov_zz_m2,hdop,reads,segment,uri\n";
  for (const auto& [epc, tag] : last.tags) {
    fmt::format_to(std::back_inserter(text), "{},{},", epc.hex(), evaluate::label_of(tag.status));
    if (evaluate::is_located(tag)) {
      const Eigen::Vector3d& p = tag.p_W_X_m;
      const Eigen::Matrix3d& c = tag.covariance_m2;
      fmt::format_to(std::back_inserter(text), "{:.6f},{:.6f},{:.6f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.6g}",
                     p.x(), p.y(), p.z(), c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2), tag.hdop);
    } else {
      text += ",,,,,,,,,";
    }
    fmt::format_to(std::back_inserter(text), ",{},{},{}\n", tag.reads, tag.segment, epc_tag_uri(epc).value_or(""));
  }
  return text;
}

std::string to_tags_json(const evaluate::LastEstimates& last) {
  using Json = nlohmann::ordered_json;
  const auto array_of = [](const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); };
  const auto rows_of = [&](const Eigen::Matrix3d& m) {
    return Json::array({array_of(m.row(0)), array_of(m.row(1)), array_of(m.row(2))});
  };
  Json features = Json::array();
  for (const auto& [epc, tag] : last.tags) {
    Json properties{{"epc", epc.hex()}};
    const auto uri = epc_tag_uri(epc);
    properties["uri"] = uri ? Json(*uri) : Json(nullptr);
    properties["status"] = evaluate::label_of(tag.status);
    properties["reads"] = tag.reads;
    Json geometry = nullptr;
    if (evaluate::is_located(tag)) {
      geometry = {{"type", "Point"}, {"coordinates", array_of(tag.p_W_X_m)}};
      properties["covariance_m2"] = rows_of(tag.covariance_m2);
      properties["hypotheses"] = Json::array();
      for (const TagHypothesis& h : tag.hypotheses)
        properties["hypotheses"].push_back({{"position_m", array_of(h.p_W_X_m)}, {"weight", h.weight}});
    }
    features.push_back({{"type", "Feature"}, {"id", epc.hex()}, {"geometry", geometry}, {"properties", properties}});
  }
  const Json json{{"type", "FeatureCollection"},
                  {"frame", "W: metres; x forward, y left, z up of the cart where it started"},
                  {"features", features}};
  return json.dump(2) + "\n";
}

}  // namespace rfmvo
