#include "reproduce/json.hpp"

#include <nlohmann/json.hpp>

#include "reproduce/figures.hpp"
#include "reproduce/reasons.hpp"
#include "reproduce/summary.hpp"

namespace rfmvo::reproduce {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json summary_json(const Study& study) {
  Json rows = Json::array();
  for (const SummaryRow& row : summary_of(study)) {
    Json json{{"id", row.id}, {"quantity", row.quantity}, {"unit", row.unit}};
    json["published"] = row.published.empty() ? Json(nullptr) : Json(row.published);
    for (std::size_t c = 0; c < kColumns; ++c) json[kColumnKeys[c]] = number(row.values[c]);
    rows.push_back(std::move(json));
  }
  return rows;
}

Json figures_json(const std::vector<FigureData>& figures) {
  Json list = Json::array();
  for (const FigureData& figure : figures) {
    Json json{{"id", figure.id}, {"heading", figure.heading}, {"x", figure.x}, {"y", figure.y}};
    json["y2"] = figure.y2.empty() ? Json(nullptr) : Json(figure.y2);
    json["curves"] = Json::array();
    for (const Curve& curve : figure.curves)
      json["curves"].push_back({{"key", curve.key}, {"second_axis", curve.second_axis}, {"points", curve.points}});
    list.push_back(std::move(json));
  }
  return list;
}

Json side_json(const SweepPoint::Side& side) {
  return {{"arrays", side.arrays},
          {"tag_error_mean_m", number(side.tag_error_mean_m)},
          {"tag_error_median_m", number(side.tag_error_median_m)},
          {"scale_absolute_mean", number(side.scale_absolute_mean)},
          {"scale_relative_mean", number(side.scale_relative_mean)},
          {"scale_relative_median", number(side.scale_relative_median)}};
}

Json sweeps_json(const std::vector<Sweep>& sweeps) {
  Json list = Json::array();
  for (const Sweep& sweep : sweeps) {
    Json json{{"parameter", sweep.parameter}, {"unit", sweep.unit}};
    for (const auto& [key, points] : {std::pair("paper", &sweep.paper), std::pair("repaired", &sweep.repaired)}) {
      json[key] = Json::array();
      for (const SweepPoint& point : *points)
        json[key].push_back({{"value", point.value},
                             {"arrays_due", point.arrays_due},
                             {"search", side_json(point.search)},
                             {"optimized", side_json(point.optimized)}});
    }
    list.push_back(std::move(json));
  }
  return list;
}

Json conditions_json(const std::vector<Condition>& conditions) {
  Json list = Json::array();
  for (const Condition& c : conditions) {
    Json json{{"name", c.name}, {"tags", c.tags}};
    for (const auto& [key, side] : {std::pair("paper", &c.paper), std::pair("repaired", &c.repaired)})
      json[key] = {{"located", side->located},
                   {"within_15_cm", side->good},
                   {"tag_error_median_m", number(side->tag_error_median_m)},
                   {"scale_relative_median", number(side->scale_relative_median)}};
    list.push_back(std::move(json));
  }
  return list;
}

Json fate_json(const Fate& fate) {
  return {{"tags", fate.tags},
          {"tags_with_enough_reads", fate.tags_with_enough_reads},
          {"arrays_due", fate.due},
          {"without_range", fate.without_range},
          {"truth_excluded", fate.truth_excluded},
          {"not_converged", fate.not_converged},
          {"wrong", fate.wrong},
          {"good", fate.good},
          {"span_s", fate.span_s},
          {"travel_m", fate.travel_m},
          {"distance_m", fate.distance_m},
          {"curvature_rad", fate.curvature_rad}};
}

Json tags_json(const Study& study) {
  Json list = Json::array();
  for (const Run& run : study.runs) {
    ByMethod<std::vector<std::optional<double>>> errors_m;
    for (const Method method : kAllMethods) errors_m[index_of(method)] = tag_errors_m(run, method);
    for (std::size_t tag = 0; tag < run.tagoram.size(); ++tag) {
      Json json{{"seed", run.seed}, {"tag", tag + 1}};
      for (const Method method : kAllMethods) {
        const auto& of_method = errors_m[index_of(method)];
        json["error_m"][key_of(method)] = tag < of_method.size() ? number(of_method[tag]) : Json(nullptr);
      }
      list.push_back(std::move(json));
    }
  }
  return list;
}

Json study_json(const Study& study, const std::vector<FigureData>& figures) {
  return {
      {"scene", study.scene},
      {"summary", summary_json(study)},
      {"figures", figures_json(figures)},
      {"reasons",
       {{"paper", fate_json(fate_of(study, &Run::paper))}, {"repaired", fate_json(fate_of(study, &Run::repaired))}}},
      {"tags", tags_json(study)}};
}

}  // namespace

std::string to_json(const Options& options, const Results& results) {
  Json json{{"options",
             {{"runs", options.runs},
              {"first_seed", options.first_seed},
              {"sweep_runs", results.sweep_runs},
              {"tags", options.tags == 0 ? Json(nullptr) : Json(options.tags)},
              {"images", options.images_dir.empty() ? Json(nullptr) : Json(options.images_dir)}}}};
  json.update(study_json(results.wall, figures_of(results)));
  json["sweeps"] = sweeps_json(results.sweeps);
  json["conditions"] = conditions_json(results.conditions);
  json["run_times"] = Json::array();
  for (const RunTime& time : results.run_times)
    json["run_times"].push_back({{"what", time.what},
                                 {"published", time.paper.empty() ? Json(nullptr) : Json(time.paper)},
                                 {"measured_s", time.measured_s}});
  json["real_frames"] =
      results.real_frames ? study_json(*results.real_frames, real_frame_figures(*results.real_frames)) : Json(nullptr);
  return json.dump(1) + "\n";
}

}  // namespace rfmvo::reproduce
