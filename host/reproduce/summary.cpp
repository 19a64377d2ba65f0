#include "reproduce/summary.hpp"

#include <fmt/format.h>

#include <cmath>

#include "evaluate/evaluation.hpp"
#include "reproduce/published.hpp"

namespace rfmvo::reproduce {
namespace {

constexpr double kCmPerM = 100.0, kPercent = 100.0;

// Methods of the columns without and with section IV; only the paper's estimator has the first.
constexpr std::array<Method, kColumns> kWith{Method::kPaper, Method::kRepaired, Method::kJoint, Method::kTagoram,
                                             Method::kMobiTagbot};
constexpr std::array<Method, 2> kWithout{Method::kPaperSearch, Method::kRepairedSearch};

std::optional<double> mean(const std::vector<double>& values) {
  const auto summary = evaluate::summarise(values);
  return summary ? std::optional(summary->mean) : std::nullopt;
}

std::optional<double> median(const std::vector<double>& values) {
  const auto summary = evaluate::summarise(values);
  return summary ? std::optional(summary->median) : std::nullopt;
}

std::optional<double> deviation(const std::vector<double>& values) {
  const auto summary = evaluate::summarise(values);
  if (!summary) return std::nullopt;
  return std::sqrt(std::max(0.0, summary->rmse * summary->rmse - summary->mean * summary->mean));
}

using Statistic = std::optional<double> (*)(const std::vector<double>&);

std::optional<double> times(std::optional<double> value, double factor) {
  return value ? std::optional(*value * factor) : std::nullopt;
}

SummaryRow tag_row(const Study& study, const char* id, const char* quantity, std::string published, Statistic statistic,
                   bool optimized) {
  SummaryRow row{id, quantity, "cm", std::move(published), {}, 1};
  for (std::size_t c = 0; c < (optimized ? kColumns : kWithout.size()); ++c) {
    const Method method = optimized ? kWith[c] : kWithout[c];
    row.values[c] = times(statistic(all_tag_errors_m(study, method)), kCmPerM);
  }
  return row;
}

SummaryRow located_row(const Study& study, const char* id, const char* quantity, bool optimized) {
  SummaryRow row{id, quantity, "%", "100", {}, 0};
  const auto tags = static_cast<double>(all_tags(study));
  for (std::size_t c = 0; c < (optimized ? kColumns : kWithout.size()) && tags > 0.0; ++c) {
    const Method method = optimized ? kWith[c] : kWithout[c];
    row.values[c] = kPercent * static_cast<double>(all_tag_errors_m(study, method).size()) / tags;
  }
  return row;
}

SummaryRow scale_row(const Study& study, const char* id, const char* quantity, const char* unit, std::string published,
                     Statistic statistic, double ScaleError::*error, bool optimized) {
  const bool relative = error == &ScaleError::relative;
  SummaryRow row{id, quantity, unit, std::move(published), {}, relative ? 2 : 4};
  for (std::size_t c = 0; c < (optimized ? 3U : kWithout.size()); ++c) {
    std::vector<double> values;
    for (const ScaleError& e : all_scale_errors(study, optimized ? kWith[c] : kWithout[c])) values.push_back(e.*error);
    row.values[c] = times(statistic(values), relative ? kPercent : 1.0);
  }
  return row;
}

// The paper's own numbers for the baselines, in their columns.
SummaryRow published_baselines_row() {
  SummaryRow row{"published_baselines", "published for the baselines, mean", "cm", "", {}, 2};
  row.values[static_cast<std::size_t>(Column::kTagoram)] = kCmPerM * published::kTagoram_m;
  row.values[static_cast<std::size_t>(Column::kMobiTagbot)] = kCmPerM * published::kMobiTagbot_m;
  return row;
}

// Share of the positions in the outermost layer of the region.
SummaryRow edge_row(const Study& study) {
  SummaryRow row{"at_edge", "at the edge of the given region", "%", "", {}, 0};
  const auto share = [&](std::vector<std::optional<BaselineTag>> Run::*tags) -> std::optional<double> {
    double all = 0.0, edge = 0.0;
    for (const Run& run : study.runs)
      for (const auto& tag : run.*tags) {
        if (!tag) continue;
        all += 1.0;
        if (tag->at_edge) edge += 1.0;
      }
    return all > 0.0 ? std::optional(kPercent * edge / all) : std::nullopt;
  };
  row.values[static_cast<std::size_t>(Column::kTagoram)] = share(&Run::tagoram);
  row.values[static_cast<std::size_t>(Column::kMobiTagbot)] = share(&Run::mobitagbot);
  return row;
}

}  // namespace

std::vector<double> all_tag_errors_m(const Study& study, Method method) {
  std::vector<double> errors;
  for (const Run& run : study.runs)
    for (const auto& error : tag_errors_m(run, method))
      if (error) errors.push_back(*error);
  return errors;
}

std::vector<ScaleError> all_scale_errors(const Study& study, Method method) {
  std::vector<ScaleError> errors;
  for (const Run& run : study.runs) {
    const auto& of_run = scale_errors(run, method);
    errors.insert(errors.end(), of_run.begin(), of_run.end());
  }
  return errors;
}

std::size_t all_tags(const Study& study) {
  std::size_t tags = 0;
  for (const Run& run : study.runs) tags += run.tagoram.size();
  return tags;
}

std::vector<SummaryRow> summary_of(const Study& study) {
  using namespace published;  // NOLINT(google-build-using-namespace): its names say so
  const std::string tag = fmt::format("{:.2f}", kCmPerM * kTagError_m);
  const char* unit = "m/unit";
  return {
      located_row(study, "located_search", "located without joint optimization", false),
      tag_row(study, "tag_error_search_mean", "tag error without it, mean",
              fmt::format("{:.2f}", kCmPerM * kTagErrorSearch_m), mean, false),
      tag_row(study, "tag_error_search_median", "the same, median", "", median, false),
      located_row(study, "located", "located with joint optimization", true),
      published_baselines_row(),
      tag_row(study, "tag_error_mean", "tag error, mean", tag, mean, true),
      tag_row(study, "tag_error_deviation", "the same, standard deviation", "", deviation, true),
      tag_row(study, "tag_error_median", "the same, median", "", median, true),
      edge_row(study),
      scale_row(study, "scale_absolute_search", "scale error without it, Eq. (31), mean", unit,
                fmt::format("{} ± {}", kScaleSearch, kScaleSearchSigma), mean, &ScaleError::absolute, false),
      scale_row(study, "scale_relative_search", "the same, of the true scale", "%", "", mean, &ScaleError::relative,
                false),
      scale_row(study, "scale_absolute", "scale error, Eq. (31), mean", unit,
                fmt::format("{} ± {}", kScale, kScaleSigma), mean, &ScaleError::absolute, true),
      scale_row(study, "scale_absolute_deviation", "the same, standard deviation", unit, "", deviation,
                &ScaleError::absolute, true),
      scale_row(study, "scale_relative", "the same, of the true scale", "%", "", mean, &ScaleError::relative, true),
      scale_row(study, "scale_relative_median", "the same, median", "%", "", median, &ScaleError::relative, true),
  };
}

}  // namespace rfmvo::reproduce
