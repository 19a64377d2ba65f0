// The frame of a page that opens offline: one file, no script, nothing from elsewhere.
#pragma once

#include <optional>
#include <string>

#include "base/result.hpp"
#include "report/gnuplot.hpp"

namespace rfmvo::report {

// Texts are plain; they are escaped here.
struct Figure {
  std::string heading;
  std::string caption;
  std::string nothing;  // said where there is no plot
  std::optional<Plot> plot;
};

[[nodiscard]] std::string legend_of(const Plot& plot);

// A section with heading, caption, legend and drawing. Errors: as draw().
[[nodiscard]] Result<std::string> figure_section(const Figure& figure);

// `body`: HTML.
[[nodiscard]] std::string page(const std::string& title, const std::string& body);

}  // namespace rfmvo::report
