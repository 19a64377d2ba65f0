#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/plots.hpp"
#include "report/script.hpp"

namespace rfmvo::report {
namespace {

constexpr int kWidth = 1000, kHeight = 340;
constexpr std::size_t kMaxPoints = 300;   // of one line; more cannot be seen
constexpr std::size_t kMaxTagLines = 60;  // more would be a smear
constexpr double kShownSigma = 0.5;       // a scale less certain than 50 % is not worth the plot's range
constexpr double kCmPerM = 100.0;

struct Range {
  double low = 1e300, high = -1e300;
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

// The last point always counts, whatever its sigma.
Range scale_range(const ReportData& data) {
  Range range;
  for (const ScalePoint& p : data.scale_history) {
    if (p.log_sigma > kShownSigma && &p != &data.scale_history.back()) continue;
    const double sigma = std::min(p.log_sigma, kShownSigma);
    range.add(p.m_per_unit * (1.0 - 2.0 * sigma));
    range.add(p.m_per_unit * (1.0 + 2.0 * sigma));
  }
  if (data.evaluation && data.evaluation->scale.true_m_per_unit) range.add(*data.evaluation->scale.true_m_per_unit);
  const double margin = 0.05 * (range.high - range.low) + 1e-6 * std::abs(range.high);
  return {range.low - margin, range.high + margin};
}

std::string scale_data(const ReportData& data) {
  const std::size_t step = data.scale_history.size() / (10 * kMaxPoints) + 1;
  std::string text;
  for (std::size_t i = 0; i < data.scale_history.size(); i += step) {
    const ScalePoint& p = data.scale_history[i];
    // A new segment has a new unit of V: the line breaks.
    if (i > 0 && data.scale_history[i - step].segment != p.segment) text += '\n';
    text += fmt::format("{:.3f} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g}\n", p.time_s, p.m_per_unit,
                        p.m_per_unit * std::exp(-2.0 * p.log_sigma), p.m_per_unit * std::exp(2.0 * p.log_sigma),
                        p.m_per_unit * std::exp(-p.log_sigma), p.m_per_unit * std::exp(p.log_sigma));
  }
  return text;
}

double end_time_s(const ReportData& data) { return std::max(data.duration.seconds(), 1e-3); }

// The value below which this share of the sorted values lies.
double quantile(const std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

// Over the tags, of each tag's newest sigma: time, 10 %, median, 90 %.
std::string sigma_quantiles(const ReportData& data) {
  std::string text;
  for (std::size_t k = 0; k <= kMaxPoints; ++k) {
    const double time = end_time_s(data) * static_cast<double>(k) / kMaxPoints;
    std::vector<double> sigmas;
    for (const auto& [epc, history] : data.sigma_history) {
      const auto after = std::upper_bound(history.begin(), history.end(), time,
                                          [](double t, const SigmaPoint& p) { return t < p.time_s; });
      if (after != history.begin()) sigmas.push_back((after - 1)->sigma_m);
    }
    if (sigmas.empty()) continue;
    std::sort(sigmas.begin(), sigmas.end());
    text += fmt::format("{:.3f} {:.4g} {:.4g} {:.4g}\n", time, quantile(sigmas, 0.1) * kCmPerM,
                        evaluate::summarise(sigmas)->median * kCmPerM, quantile(sigmas, 0.9) * kCmPerM);
  }
  return text;
}

}  // namespace

std::string axes_style() {
  return fmt::format(
      "set border 3 lc rgb '{0}' lw 1\nset tics nomirror out scale 0.6 tc rgb '{0}'\n"
      "set grid lc rgb '{1}' lt 1 lw 0.6\nset key tc rgb '{0}' samplen 1.6 spacing 1.1\n"
      "set xlabel tc rgb '{0}'\nset ylabel tc rgb '{0}'\n",
      kInk.gnuplot, kGrid.gnuplot);
}

std::string Script::text() const {
  std::string blocks, plot;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    blocks += fmt::format("$d{} << EOD\n{}EOD\n", i, layers_[i].data);
    plot += fmt::format("{} $d{} {}", i == 0 ? "plot" : ", \\\n    ", i, layers_[i].style);
  }
  return blocks + plot + "\n";
}

std::optional<Plot> scale_over_time(const ReportData& data) {
  if (data.scale_history.empty()) return std::nullopt;
  const Range range = scale_range(data);
  const std::string points = scale_data(data);
  Script script;
  script.add(
      {points, fmt::format("using 1:3:4 with filledcurves fs transparent solid 0.14 noborder lc rgb '{}' title '2 σ'",
                           kGood.gnuplot)});
  script.add(
      {points, fmt::format("using 1:5:6 with filledcurves fs transparent solid 0.24 noborder lc rgb '{}' title '1 σ'",
                           kGood.gnuplot)});
  script.add({points, fmt::format("using 1:2 with lines lw 2 lc rgb '{}' title 'scale'", kGood.gnuplot)});
  if (data.evaluation && data.evaluation->scale.true_m_per_unit) {
    const double truth = *data.evaluation->scale.true_m_per_unit;
    script.add({fmt::format("0 {0:.6g}\n{1:.3f} {0:.6g}\n", truth, end_time_s(data)),
                fmt::format("with lines lw 1.5 dt '-' lc rgb '{}' title 'true'", kTruth.gnuplot)});
  }
  Plot plot{.name = "scale",
            .title = "Scale over time",
            .width = kWidth,
            .height = kHeight,
            .script = axes_style(),
            .legend = {}};
  plot.script += fmt::format(
      "set key top right horizontal\nset xlabel 'time (s)'\nset ylabel 'metres per unit of odometry'\n"
      "set xrange [0:{:.3f}]\nset yrange [{:.6g}:{:.6g}]\n",
      end_time_s(data), range.low, range.high);
  plot.script += script.text();
  return plot;
}

std::optional<Plot> tag_sigma_over_time(const ReportData& data) {
  std::string lines;
  const bool many = data.sigma_history.size() > kMaxTagLines;
  if (data.sigma_history.empty()) return std::nullopt;
  for (const auto& [epc, history] : data.sigma_history) {
    if (many) break;
    const std::size_t step = history.size() / kMaxPoints + 1;
    for (std::size_t i = 0; i < history.size(); i += step) {
      lines += fmt::format("{:.3f} {:.4g}\n", history[i].time_s, history[i].sigma_m * kCmPerM);
    }
    lines += '\n';
  }
  const std::string quantiles = sigma_quantiles(data);
  Script script;
  if (many)
    script.add({quantiles, fmt::format("using 1:2:4 with filledcurves fs transparent solid 0.2 noborder lc rgb '{}' "
                                       "title '10 to 90 % of the tags'",
                                       kGood.gnuplot)});
  script.add({lines, fmt::format("with lines lw 0.8 lc rgb '{}' title 'one tag'", kPath.gnuplot)});
  script.add(
      {quantiles, fmt::format("using 1:3 with lines lw 2.5 lc rgb '{}' title 'median of the tags'", kGood.gnuplot)});
  Plot plot{.name = "sigma",
            .title = "Certainty of the tags over time",
            .width = kWidth,
            .height = kHeight,
            .script = axes_style(),
            .legend = {}};
  plot.script += fmt::format(
      "set key top right horizontal\nset logscale y\nset xlabel 'time (s)'\nset ylabel 'σ of the worst axis (cm)'\n"
      "set xrange [0:{:.3f}]\n",
      end_time_s(data));
  plot.script += script.text();
  return plot;
}

}  // namespace rfmvo::report
