#include "reproduce/curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/plots.hpp"
#include "report/script.hpp"

namespace rfmvo::reproduce {
namespace {

constexpr int kWidth = 1000;
constexpr std::size_t kMaxPoints = 300;  // of one curve; more cannot be seen

std::string data_of(const Curve& curve) {
  const std::size_t step = curve.points.size() / (4 * kMaxPoints) + 1;
  std::string text;
  for (std::size_t i = 0; i < curve.points.size(); i += step) {
    const auto& [x, y] = curve.points[i];
    if (std::isfinite(x) && std::isfinite(y)) text += fmt::format("{:.6g} {:.6g}\n", x, y);
  }
  return text;
}

std::string style_of(const Curve& curve) {
  std::string style = curve.second_axis ? "axes x1y2 " : "";
  switch (curve.marks) {
    case Curve::Marks::kLine:
      style += "with lines lw 2";
      break;
    case Curve::Marks::kLineAndPoints:
      style += "with linespoints pt 7 ps 0.6 lw 2";
      break;
    case Curve::Marks::kPoints:
      style += "with points pt 7 ps 0.35";
      break;
  }
  if (curve.dashed && curve.marks != Curve::Marks::kPoints) style += " dt '-'";
  return style + fmt::format(" lc rgb '{}' notitle", curve.colour->gnuplot);
}

const char* symbol_of(const Curve& curve) {
  if (curve.marks == Curve::Marks::kPoints) return "●";
  return curve.dashed ? "╌╌" : "━━";
}

std::string axes_of(const FigureData& figure) {
  std::string script = report::axes_style() + fmt::format("set xlabel '{}'\nset ylabel '{}'\n", figure.x, figure.y);
  if (!figure.y2.empty())
    script += fmt::format("set border 11\nset ytics nomirror\nset y2tics\nset y2label '{}' tc rgb '{}'\n", figure.y2,
                          report::kInk.gnuplot);
  if (figure.log_x) script += "set logscale x\n";
  if (figure.log_y) script += "set logscale y\n";
  if (figure.share) script += "set yrange [0:1]\n";
  if (figure.equal_axes) script += "set size ratio -1\n";
  return script;
}

}  // namespace

Curve curve_of(Method method) {
  const auto look = [&](const char* title, const report::PlotColour& colour, bool dashed) {
    Curve curve;
    curve.key = key_of(method);
    curve.title = title;
    curve.colour = &colour;
    curve.dashed = dashed;
    return curve;
  };
  switch (method) {
    case Method::kPaperSearch:
      return look("paper, without joint optimization", report::kDoubt, true);
    case Method::kPaper:
      return look("paper, with it", report::kDoubt, false);
    case Method::kRepairedSearch:
      return look("paper repaired, without", report::kStale, true);
    case Method::kRepaired:
      return look("paper repaired, with", report::kStale, false);
    case Method::kJoint:
      return look("joint", report::kGood, false);
    case Method::kTagoram:
      return look("Tagoram", report::kTruth, false);
    case Method::kMobiTagbot:
      return look("MobiTagbot", report::kInk, false);
  }
  return {};
}

std::vector<std::pair<double, double>> distribution(std::vector<double> values, std::size_t all) {
  std::sort(values.begin(), values.end());
  std::vector<std::pair<double, double>> points;
  const std::size_t step = values.size() / kMaxPoints + 1;
  if (!values.empty()) points.emplace_back(values.front(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (i % step == 0 || i + 1 == values.size())
      points.emplace_back(values[i], static_cast<double>(i + 1) / static_cast<double>(all));
  return points;
}

std::optional<report::Plot> plot_of(const FigureData& figure) {
  report::Script script;
  std::vector<report::LegendEntry> legend;
  bool drawn = false;
  for (const Curve& curve : figure.curves) {
    const bool any = script.add({data_of(curve), style_of(curve)});
    legend.push_back({curve.colour->css, any ? symbol_of(curve) : "·", curve.title + (any ? "" : ": no answer")});
    drawn = drawn || any;
  }
  if (!drawn) return std::nullopt;
  report::Plot plot{.name = figure.id,
                    .title = figure.heading,
                    .width = kWidth,
                    .height = figure.height,
                    .script = axes_of(figure) + script.text(),
                    .legend = std::move(legend)};
  return plot;
}

}  // namespace rfmvo::reproduce
