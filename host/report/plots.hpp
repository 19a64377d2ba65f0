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

// Over time; nothing if there never was a scale, a located tag.
[[nodiscard]] std::optional<Plot> scale_over_time(const ReportData& data);
[[nodiscard]] std::optional<Plot> tag_sigma_over_time(const ReportData& data);

// Frame, grid and legend as all plots have them.
[[nodiscard]] std::string axes_style();

}  // namespace rfmvo::report
