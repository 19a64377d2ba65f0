// Plots by gnuplot, run as a program of its own: script in, SVG out.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"

namespace rfmvo::report {

// Colours in scripts are placeholders that gnuplot can parse; in the SVG they become CSS variables, so the
// page decides how they look (light, dark, paper).
struct PlotColour {
  const char* gnuplot;   // "#rrggbb" as scripts write it
  const char* svg;       // the same as gnuplot's SVG terminal writes it on lines
  const char* svg_text;  // and on text
  const char* css;       // what it becomes
};
inline constexpr PlotColour kInk{"#010101", "rgb(  1,   1,   1)", "rgb(1,1,1)", "var(--ink)"};
inline constexpr PlotColour kGrid{"#020202", "rgb(  2,   2,   2)", "rgb(2,2,2)", "var(--grid)"};
inline constexpr PlotColour kPath{"#030303", "rgb(  3,   3,   3)", "rgb(3,3,3)", "var(--path)"};
inline constexpr PlotColour kGood{"#040404", "rgb(  4,   4,   4)", "rgb(4,4,4)", "var(--good)"};
inline constexpr PlotColour kDoubt{"#050505", "rgb(  5,   5,   5)", "rgb(5,5,5)", "var(--doubt)"};
inline constexpr PlotColour kStale{"#060606", "rgb(  6,   6,   6)", "rgb(6,6,6)", "var(--stale)"};
inline constexpr PlotColour kTruth{"#070707", "rgb(  7,   7,   7)", "rgb(7,7,7)", "var(--truth)"};

struct LegendEntry {
  const char* css;     // colour
  const char* symbol;  // one character that looks like the marks in the plot
  std::string text;
};

struct Plot {
  std::string name;   // letters only: prefix of the ids in the SVG
  std::string title;  // for screen readers
  int width = 900, height = 400;
  std::string script;               // after `set terminal` and `set output`
  std::vector<LegendEntry> legend;  // for the page; empty: the script has its own
};

// An <svg> element to put into a page. Errors: gnuplot is not installed; what gnuplot complains about.
[[nodiscard]] Result<std::string> draw(const Plot& plot);

// The pure half of draw(): what gnuplot wrote, made fit for a page.
[[nodiscard]] std::string inline_svg(const std::string& svg_file, const Plot& plot);

}  // namespace rfmvo::report
