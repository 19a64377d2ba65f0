#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "inspect/result_diff.hpp"

namespace rfmvo::inspect {
namespace {

using Json = nlohmann::ordered_json;

std::string side(const std::optional<TagEstimate>& tag) {
  if (!tag) return "absent";
  if (!evaluate::is_located(*tag)) return evaluate::label_of(tag->status);
  const Eigen::Vector3d& p = tag->p_W_X_m;
  return fmt::format("{} {:.3f} {:.3f} {:.3f} m", evaluate::label_of(tag->status), p.x(), p.y(), p.z());
}

std::string side(const std::optional<ScaleEstimate>& scale) {
  if (!scale) return "absent";
  if (!scale->observable) return "not observable";
  return fmt::format("{:.6g} m per unit ± {:.2g} %", scale->m_per_unit, scale->log_sigma * 100.0);
}

std::string text_of(const TagDifference& d) {
  return fmt::format("tag {}: {} | {}{}\n", d.epc.hex(), side(d.a), side(d.b),
                     d.distance_m ? fmt::format(" : {:.2f} cm apart", *d.distance_m * 100.0) : "");
}

std::string text_of(const ScaleDifference& d) {
  return fmt::format("scale of segment {}: {} | {}{}\n", d.segment, side(d.a), side(d.b),
                     d.relative ? fmt::format(" : {:+.3f} %", *d.relative * 100.0) : "");
}

std::string text_of(const PathDifference& d) {
  std::string text = fmt::format("path of segment {}: {} | {} poses", d.segment, d.poses_a, d.poses_b);
  if (d.compared > 0)
    text += fmt::format(" : {:.2f} cm apart RMS, {:.2f} cm at {}.{:06} s", d.rms_m * 100.0, d.max_m * 100.0,
                        d.max_at.us() / 1'000'000, d.max_at.us() % 1'000'000);
  return text + "\n";
}

template <class Difference>
std::string differing(const std::vector<Difference>& differences, double tolerance) {
  std::string text;
  for (const Difference& d : differences)
    if (!d.within(tolerance)) text += text_of(d);
  return text;
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json tag_json(const std::optional<TagEstimate>& tag) {
  if (!tag) return nullptr;
  Json json{{"status", evaluate::label_of(tag->status)}};
  if (evaluate::is_located(*tag)) json["position_m"] = {tag->p_W_X_m.x(), tag->p_W_X_m.y(), tag->p_W_X_m.z()};
  return json;
}

Json scale_json(const std::optional<ScaleEstimate>& scale) {
  if (!scale || !scale->observable) return nullptr;
  return Json{{"m_per_unit", scale->m_per_unit}, {"log_sigma", scale->log_sigma}};
}

}  // namespace

std::string to_text(const ResultDiff& diff, const Tolerance& tolerance) {
  if (!diff.first) return fmt::format("the same, byte for byte: {} records\n", diff.records_a);
  if (!tolerance.none() && diff.same(tolerance)) return "the same, within the tolerance\n";
  std::string text;
  for (const SettingDifference& s : diff.settings) text += fmt::format("{}: {} | {}\n", s.key, s.a, s.b);
  text += differing(diff.tags, tolerance.position_m) + differing(diff.scales, tolerance.scale) +
          differing(diff.paths, tolerance.position_m);
  return text + fmt::format("first record that differs: number {}: {} | {}; records: {} | {}\n", diff.first->index,
                            diff.first->a, diff.first->b, diff.records_a, diff.records_b);
}

std::string to_json(const ResultDiff& diff, const Tolerance& tolerance) {
  Json json{{"same", diff.same(tolerance)},
            {"same_bytes", !diff.first},
            {"tolerance_m", tolerance.position_m},
            {"tolerance_scale", tolerance.scale},
            {"records", {diff.records_a, diff.records_b}}};
  json["first_difference"] =
      diff.first ? Json{{"record", diff.first->index}, {"a", diff.first->a}, {"b", diff.first->b}} : Json(nullptr);
  json["settings"] = Json::array();
  for (const SettingDifference& s : diff.settings) json["settings"].push_back({{"key", s.key}, {"a", s.a}, {"b", s.b}});
  json["tags"] = Json::array();
  for (const TagDifference& d : diff.tags)
    json["tags"].push_back({{"epc", d.epc.hex()},
                            {"a", tag_json(d.a)},
                            {"b", tag_json(d.b)},
                            {"distance_m", or_null(d.distance_m)},
                            {"same", d.within(tolerance.position_m)}});
  json["scales"] = Json::array();
  for (const ScaleDifference& d : diff.scales)
    json["scales"].push_back({{"segment", d.segment},
                              {"a", scale_json(d.a)},
                              {"b", scale_json(d.b)},
                              {"relative", or_null(d.relative)},
                              {"same", d.within(tolerance.scale)}});
  json["paths"] = Json::array();
  for (const PathDifference& d : diff.paths)
    json["paths"].push_back({{"segment", d.segment},
                             {"poses", {d.poses_a, d.poses_b}},
                             {"compared", d.compared},
                             {"rms_m", d.rms_m},
                             {"max_m", d.max_m},
                             {"same", d.within(tolerance.position_m)}});
  return json.dump(2) + "\n";
}

}  // namespace rfmvo::inspect
