#include <nlohmann/json.hpp>

#include "montecarlo/statistics_text.hpp"

namespace rfmvo::montecarlo {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json part(const std::optional<evaluate::Summary>& s, double evaluate::Summary::*field) {
  return s ? Json((*s).*field) : Json(nullptr);
}

Json counted(std::size_t count, std::size_t of) {
  const double share = of > 0 ? static_cast<double>(count) / static_cast<double>(of) : 0.0;
  return {{"count", count}, {"share", share}};
}

Json run_json(const Options& o) {
  const simulate::Options& s = o.simulation;
  return {{"scene", s.images_dir.empty() ? s.scene : "images"},
          {"first_seed", o.first_seed},
          {"estimator", o.estimator},
          {"from", o.own_odometry ? "frames" : "poses"},
          {"vo_class", s.vo_class},
          {"reader_delay_s", s.reader_delay_s},
          {"outliers", s.outlier_share},
          {"flips", s.flip_share},
          {"frame_gap_s", s.frame_gap_s},
          {"structured_rad", or_null(s.structured_rad)},
          {"read_rate_hz", or_null(s.read_rate_hz)}};
}

Json seed_json(const SeedRun& run) {
  using evaluate::Summary;
  const evaluate::Evaluation& e = run.evaluation;
  std::size_t wrong = 0;
  for (const auto& tag : e.tags.tags) wrong += is_unflagged_wrong(tag) ? 1 : 0;
  const double factor = run.timing.cpu_s > 0.0 ? run.timing.span_s / run.timing.cpu_s : 0.0;
  Json known_rmse_m;
  if (run.known_path) known_rmse_m = part(run.known_path->tags.camera_relative_m, &Summary::rmse);
  const bool scale_known = e.scale.estimate && e.scale.estimate->observable;
  return {{"seed", run.seed},
          {"reads", run.reads},
          {"tags", e.tags.total},
          {"located", e.tags.located},
          {"rmse_m", part(e.tags.camera_relative_m, &Summary::rmse)},
          {"bound_rmse_m", run.bound ? or_null(run.bound->rmse_m) : Json(nullptr)},
          {"lobe_bound_rmse_m", run.lobes ? or_null(run.lobes->rmse_m) : Json(nullptr)},
          {"mean_error_m", part(e.tags.camera_relative_m, &Summary::mean)},
          {"median_error_m", part(e.tags.camera_relative_m, &Summary::median)},
          {"max_error_m", part(e.tags.camera_relative_m, &Summary::max)},
          {"world_rmse_m", part(e.tags.error_m, &Summary::rmse)},
          {"known_path_rmse_m", known_rmse_m},
          {"coverage95", or_null(e.tags.coverage95)},
          {"nees", or_null(e.tags.nees_mean)},
          {"scale_relative_error", or_null(e.scale.relative_error)},
          {"scale_bound_relative", run.bound ? or_null(run.bound->scale_relative) : Json(nullptr)},
          {"scale_log_sigma", scale_known ? Json(e.scale.estimate->log_sigma) : Json(nullptr)},
          {"ate_se3_m", or_null(e.trajectory.ate_se3_m)},
          {"unflagged_wrong", wrong},
          {"run_s", run.timing.wall_s},
          {"realtime_factor", factor}};
}

Json together(const Statistics& s) {
  using evaluate::Summary;
  return {{"tags", s.tags},
          {"located", s.located},
          {"rmse_m", part(s.error_m, &Summary::rmse)},
          {"bound_rmse_m", or_null(s.bound_rmse_m)},
          {"bound_median_m", or_null(s.bound_median_m)},
          {"unbounded", s.unbounded},
          {"ratio", or_null(s.ratio)},
          {"lobe_bound_rmse_m", or_null(s.lobe_bound_rmse_m)},
          {"lobe_ratio", or_null(s.lobe_ratio)},
          {"lobe_wrong_share", or_null(s.lobe_wrong_share)},
          {"median_error_m", part(s.error_m, &Summary::median)},
          {"mean_error_m", part(s.error_m, &Summary::mean)},
          {"max_error_m", part(s.error_m, &Summary::max)},
          {"known_path_rmse_m", or_null(s.known_path_rmse_m)},
          {"known_path_bound_rmse_m", or_null(s.known_path_bound_rmse_m)},
          {"coverage95", or_null(s.coverage95)},
          {"nees", or_null(s.nees_mean)},
          {"nees_median", or_null(s.nees_median)},
          {"scale_rms_relative", or_null(s.scale_rms_relative)},
          {"scale_bound_rms_relative", or_null(s.scale_bound_rms_relative)},
          {"unflagged_wrong", counted(s.unflagged_wrong, s.tags)},
          {"unflagged_wrong_over_25cm", counted(s.unflagged_wrong_that_matters, s.tags)},
          {"false_alarms", s.false_alarms ? counted(*s.false_alarms, s.tags) : Json(nullptr)},
          {"located_sigma25_share", counted(s.located_sigma25, s.tags)["share"]},
          {"per_read_p99_ms", 1e3 * s.per_read_p99_s},
          {"run_s", s.run_s},
          {"realtime_factor", s.realtime_factor}};
}

}  // namespace

std::string to_json(const Options& options, const std::vector<SeedRun>& runs, const Statistics& statistics) {
  Json json{{"run", run_json(options)}};
  json.update(together(statistics));
  json["statuses"] = Json::object();
  for (const auto& [status, count] : statistics.statuses) json["statuses"][status] = count;
  json["seeds"] = Json::array();
  for (const SeedRun& run : runs) json["seeds"].push_back(seed_json(run));
  return json.dump(2) + "\n";
}

}  // namespace rfmvo::montecarlo
