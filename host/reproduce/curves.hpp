// Curves of the reproduction's figures: numbers first (for the JSON), then gnuplot.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/gnuplot.hpp"
#include "reproduce/results.hpp"

namespace rfmvo::reproduce {

struct Curve {
  std::string key, title;  // of the JSON, of the legend
  const report::PlotColour* colour = &report::kInk;
  bool dashed = false;
  enum class Marks : std::uint8_t { kLine, kLineAndPoints, kPoints } marks = Marks::kLine;
  bool second_axis = false;
  std::vector<std::pair<double, double>> points;
};

struct FigureData {
  std::string id;  // letters only: "figa"
  std::string heading, caption, nothing;
  std::string x, y, y2;                                                  // labels with units; y2 empty: one axis
  bool log_x = false, log_y = false, equal_axes = false, share = false;  // share: y from 0 to 1
  int height = 360;
  std::vector<Curve> curves;
};

// Name and look of a method, the same in all figures.
[[nodiscard]] Curve curve_of(Method method);

// Cumulative distribution over `all` values, of which those not in `values` are infinite: it ends at the
// share that there is. At most a few hundred points.
[[nodiscard]] std::vector<std::pair<double, double>> distribution(std::vector<double> values, std::size_t all);

// Nothing if no curve has a point.
[[nodiscard]] std::optional<report::Plot> plot_of(const FigureData& figure);

}  // namespace rfmvo::reproduce
