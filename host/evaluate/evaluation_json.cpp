#include <nlohmann/json.hpp>

#include "evaluate/evaluation_text.hpp"
#include "evaluate/last_estimates.hpp"

namespace rfmvo::evaluate {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }
Json array_of(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json tag_json(const TagEvaluation& tag) {
  Json json{{"epc", tag.epc.hex()}, {"located", tag.located}};
  if (!tag.estimate) {
    json["status"] = "NOT_SEEN";
    return json;
  }
  const TagEstimate& e = *tag.estimate;
  json["status"] = label_of(e.status);
  json["reads"] = e.reads;
  if (!tag.located) return json;
  json["segment"] = e.segment;
  json["position_m"] = array_of(e.p_W_X_m);
  json["sigma_m"] = array_of(sigma_of(e.covariance_m2));
  json["error_m"] = or_null(tag.error_m);
  json["best_hypothesis_error_m"] = or_null(tag.best_hypothesis_error_m);
  json["camera_relative_error_m"] = or_null(tag.camera_relative_error_m);
  json["sigma_camera_m"] = array_of(sigma_of(e.covariance_C_m2));
  json["nees"] = or_null(tag.nees_camera);
  json["nees_world"] = or_null(tag.nees_world);
  json["hypotheses"] = e.hypotheses.size();
  json["hdop"] = e.hdop;
  return json;
}

Json tags_json(const TagsEvaluation& tags) {
  const auto part = [](const std::optional<Summary>& s, double Summary::*field) {
    return s ? Json((*s).*field) : Json(nullptr);
  };
  Json json{{"total", tags.total},
            {"located", tags.located},
            {"mean_error_m", part(tags.error_m, &Summary::mean)},
            {"median_error_m", part(tags.error_m, &Summary::median)},
            {"rmse_m", part(tags.error_m, &Summary::rmse)},
            {"max_error_m", part(tags.error_m, &Summary::max)},
            {"camera_relative_mean_m", part(tags.camera_relative_m, &Summary::mean)},
            {"camera_relative_median_m", part(tags.camera_relative_m, &Summary::median)},
            {"camera_relative_rmse_m", part(tags.camera_relative_m, &Summary::rmse)},
            {"coverage95", or_null(tags.coverage95)},
            {"coverage95_world", or_null(tags.coverage95_world)},
            {"nees_mean", or_null(tags.nees_mean)},
            {"nees_world_mean", or_null(tags.nees_world_mean)}};
  json["unknown"] = Json::array();
  for (const Epc& epc : tags.unknown) json["unknown"].push_back(epc.hex());
  json["list"] = Json::array();
  for (const TagEvaluation& tag : tags.tags) json["list"].push_back(tag_json(tag));
  return json;
}

Json scale_json(const ScaleEvaluation& scale) {
  const bool known = scale.estimate && scale.estimate->observable;
  return {{"relative_error", or_null(scale.relative_error)},
          {"eq31", or_null(scale.eq31)},
          {"eq31_relative", or_null(scale.eq31_relative)},
          {"eq31_steps", scale.eq31_steps},
          {"observable", known},
          {"m_per_unit", known ? Json(scale.estimate->m_per_unit) : Json(nullptr)},
          {"log_sigma", known ? Json(scale.estimate->log_sigma) : Json(nullptr)},
          {"true_m_per_unit", or_null(scale.true_m_per_unit)}};
}

Json trajectory_json(const TrajectoryEvaluation& trajectory) {
  Json json{{"ate_se3_m", or_null(trajectory.ate_se3_m)},
            {"ate_sim3_m", or_null(trajectory.ate_sim3_m)},
            {"path_m", trajectory.path_m}};
  json["segments"] = Json::array();
  for (const SegmentEvaluation& s : trajectory.segments) {
    json["segments"].push_back({{"segment", s.segment},
                                {"poses", s.poses},
                                {"path_m", s.path_m},
                                {"ate_se3_m", s.ate_se3_m},
                                {"ate_sim3_m", s.ate_sim3_m},
                                {"sim3_scale", s.sim3_scale},
                                {"aligned_with_orientations", s.aligned_with_orientations}});
  }
  return json;
}

}  // namespace

std::string to_json(const Evaluation& evaluation, std::optional<double> realtime_factor) {
  const Json json{{"tags", tags_json(evaluation.tags)},
                  {"scale", scale_json(evaluation.scale)},
                  {"trajectory", trajectory_json(evaluation.trajectory)},
                  {"realtime_factor", or_null(realtime_factor)}};
  return json.dump(2) + "\n";
}

Result<std::optional<double>> realtime_factor_of(const std::string& replay_json, const std::string& where) {
  const Json json = Json::parse(replay_json, nullptr, false);
  if (json.is_discarded() || !json.is_object()) return Error{ErrorCode::kMalformed, "no JSON object", where};
  const auto found = json.find("realtime_factor");
  if (found == json.end()) return Error{ErrorCode::kMalformed, "no realtime_factor", where};
  if (found->is_null()) return std::optional<double>();
  if (!found->is_number()) return Error{ErrorCode::kMalformed, "realtime_factor is no number", where};
  return std::optional<double>(found->get<double>());
}

}  // namespace rfmvo::evaluate
