#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/plots.hpp"
#include "report/script.hpp"

namespace rfmvo::report {
namespace {

constexpr int kWidth = 1000;
constexpr std::size_t kMaxPoints = 6000;  // of all ports; more hide each other, and make the page slow
constexpr const PlotColour* kPorts[] = {&kGood, &kDoubt, &kStale, &kTruth};

// One layer a port, thinned evenly. `line`: "x y" of a read, empty to leave it out.
template <class Line>
void add_by_port(const ReportData& data, const Line& line, Script& script, std::vector<LegendEntry>& legend) {
  const auto& reads = data.journal->reads;
  const std::size_t step = reads.size() / kMaxPoints + 1;
  std::map<std::uint8_t, std::string> ports;
  for (std::size_t i = 0; i < reads.size(); i += step) ports[reads[i].port] += line(reads[i]);
  std::size_t index = 0;
  for (const auto& [port, text] : ports) {
    const PlotColour& colour = *kPorts[index++ % std::size(kPorts)];
    if (script.add({text, fmt::format("with points pt 7 ps 0.25 lc rgb '{}' notitle", colour.gnuplot)}))
      legend.push_back({colour.css, "●", fmt::format("antenna {}", port)});
  }
}

Plot plot_of(const char* name, const char* title, int height, const ReportData& data) {
  Plot plot{.name = name, .title = title, .width = kWidth, .height = height, .script = axes_style(), .legend = {}};
  plot.script += fmt::format("set key off\nset xlabel 'time (s)'\nset xrange [0:{:.3f}]\n",
                             std::max(data.duration.seconds(), 1e-3));
  return plot;
}

}  // namespace

std::optional<Plot> read_timeline(const ReportData& data) {
  if (!data.journal || data.journal->reads.empty() || data.tags.empty()) return std::nullopt;
  std::map<Epc, std::size_t> rows;
  for (std::size_t i = 0; i < data.tags.size(); ++i) rows[data.tags[i].epc] = i + 1;
  constexpr int kMinHeight = 260, kMaxHeight = 640, kPerTag_px = 14;
  const int height = std::clamp(80 + kPerTag_px * static_cast<int>(rows.size()), kMinHeight, kMaxHeight);
  Plot plot = plot_of("timeline", "Reads over time", height, data);
  Script script;
  add_by_port(
      data,
      [&](const ReadPoint& read) {
        const auto row = rows.find(read.epc);
        if (row == rows.end()) return std::string();
        return fmt::format("{:.3f} {}\n", (read.time - data.start).seconds(), row->second);
      },
      script, plot.legend);
  // The first tag on top, as in the table.
  plot.script += fmt::format("set ylabel 'tag'\nset yrange [{}.5:0.5]\n{}", rows.size(), script.text());
  return plot;
}

std::optional<Plot> phase_residual_plot(const ReportData& data) {
  if (!data.journal) return std::nullopt;
  const auto& reads = data.journal->reads;
  if (std::none_of(reads.begin(), reads.end(), [](const ReadPoint& r) { return r.residual_rad.has_value(); }))
    return std::nullopt;
  Plot plot = plot_of("residuals", "Phase residuals over time", 320, data);
  Script script;
  add_by_port(
      data,
      [&](const ReadPoint& read) {
        if (!read.residual_rad) return std::string();
        return fmt::format("{:.3f} {:.3f}\n", (read.time - data.start).seconds(), *read.residual_rad);
      },
      script, plot.legend);
  plot.script += "set ylabel 'residual (rad)'\nset yrange [-3.2:3.2]\n" + script.text();
  return plot;
}

}  // namespace rfmvo::report
