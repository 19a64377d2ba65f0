// The plots of the page as gnuplot scripts.
#pragma once

#include <optional>

#include "report/gnuplot.hpp"
#include "report/report_data.hpp"

namespace rfmvo::report {

// Maps: path, tags with 95 % ellipses (of the two shown coordinates), hypotheses, truth. Equal axes.
// Nothing if there is neither a path nor a located tag.
[[nodiscard]] std::optional<Plot> top_view(const ReportData& data);
[[nodiscard]] std::optional<Plot> side_view(const ReportData& data);  // along the horizontal axis the path is longer in

[[nodiscard]] std::optional<Plot> oblique_view(const ReportData& data);  // in three dimensions: a parallel projection

// Over time; nothing if there never was a scale, a located tag.
[[nodiscard]] std::optional<Plot> scale_over_time(const ReportData& data);
[[nodiscard]] std::optional<Plot> tag_sigma_over_time(const ReportData& data);

// Of the journal's reads; nothing without a journal. Each read over time, in its tag's row, by antenna; and what is
// left of its phase when the solution is taken off.
[[nodiscard]] std::optional<Plot> read_timeline(const ReportData& data);
[[nodiscard]] std::optional<Plot> phase_residual_plot(const ReportData& data);

// Frame, grid and legend as all plots have them.
[[nodiscard]] std::string axes_style();

}  // namespace rfmvo::report
