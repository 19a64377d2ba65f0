#include "bound/bound_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace rfmvo::bound {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kCentimetre = 0.01, kPercent = 0.01;

std::string number(const std::optional<double>& value, double unit, int digits) {
  return value ? fmt::format("{:.{}f}", *value / unit, digits) : "none";
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

std::string line(const char* name, const Bound& bound) {
  return fmt::format("{:<13} rms {} cm, median {} cm, {} of {} tags unbounded\n", name,
                     number(bound.rmse_m, kCentimetre, 2), number(bound.median_m, kCentimetre, 2), bound.unbounded,
                     bound.tags.size());
}

}  // namespace

std::string to_table(const RunBounds& bounds) {
  std::string text =
      "tag                       reads  distance   bound   x       y       z      path known  wrong  with lobes\n"
      "                                    m         cm   in the camera's frame     cm          %       cm\n";
  for (std::size_t i = 0; i < bounds.unknown.tags.size(); ++i) {
    const TagBound &tag = bounds.unknown.tags[i], &known = bounds.known.tags[i];
    const TagLobes& lobes = bounds.lobes.tags[i];
    const Eigen::Vector3d axes_cm = tag.covariance_C_m2.diagonal().cwiseSqrt() / kCentimetre;
    text += fmt::format("{:<24} {:>6} {:>8.2f} {:>9} {:>7.1f} {:>7.1f} {:>7.1f} {:>9} {:>9.1f} {:>9}\n", tag.epc.hex(),
                        tag.reads, tag.distance_m, number(tag.sigma_m, kCentimetre, 2), axes_cm.x(), axes_cm.y(),
                        axes_cm.z(), number(known.sigma_m, kCentimetre, 2), lobes.wrong_probability / kPercent,
                        number(rmse_with_lobes_m(tag, lobes), kCentimetre, 2));
  }
  text += "\n" + line("bound", bounds.unknown) + line("  path known", bounds.known);
  text += fmt::format("  with lobes  rms {} cm, {} % of the tags at a wrong place\n",
                      number(bounds.lobes.rmse_m, kCentimetre, 2), number(bounds.lobes.wrong_share, kPercent, 1));
  return text + fmt::format("scale         {} %\n", number(bounds.unknown.scale_relative, kPercent, 3));
}

std::string to_json(const RunBounds& bounds) {
  Json json{{"bound_rmse_m", or_null(bounds.unknown.rmse_m)},
            {"bound_median_m", or_null(bounds.unknown.median_m)},
            {"unbounded", bounds.unknown.unbounded},
            {"scale_bound_relative", or_null(bounds.unknown.scale_relative)},
            {"known_path_bound_rmse_m", or_null(bounds.known.rmse_m)},
            {"known_path_bound_median_m", or_null(bounds.known.median_m)},
            {"known_path_unbounded", bounds.known.unbounded},
            {"lobe_bound_rmse_m", or_null(bounds.lobes.rmse_m)},
            {"lobe_wrong_share", bounds.lobes.wrong_share},
            {"tags", Json::array()}};
  for (std::size_t i = 0; i < bounds.unknown.tags.size(); ++i) {
    const TagBound& tag = bounds.unknown.tags[i];
    const Eigen::Vector3d axes_m = tag.covariance_C_m2.diagonal().cwiseSqrt();
    json["tags"].push_back({{"epc", tag.epc.hex()},
                            {"reads", tag.reads},
                            {"distance_m", tag.distance_m},
                            {"sigma_m", or_null(tag.sigma_m)},
                            {"sigma_C_m", tag.sigma_m ? Json({axes_m.x(), axes_m.y(), axes_m.z()}) : Json(nullptr)},
                            {"known_path_sigma_m", or_null(bounds.known.tags[i].sigma_m)},
                            {"lobes", bounds.lobes.tags[i].lobes},
                            {"lobe_wrong_probability", bounds.lobes.tags[i].wrong_probability},
                            {"lobe_rmse_m", or_null(rmse_with_lobes_m(tag, bounds.lobes.tags[i]))}});
  }
  return json.dump(2) + "\n";
}

}  // namespace rfmvo::bound
