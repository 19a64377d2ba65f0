// The parts of the page that are text: HTML fragments.
#pragma once

#include <string>

#include "report/report_data.hpp"

namespace rfmvo::report {

[[nodiscard]] std::string header_section(const ReportData& data);
[[nodiscard]] std::string summary_cards(const ReportData& data);
[[nodiscard]] std::string tag_table(const ReportData& data);
[[nodiscard]] std::string health_table(const ReportData& data);
[[nodiscard]] std::string fault_table(const ReportData& data);
// What the plot of the residuals shows, with their size.
[[nodiscard]] std::string residual_caption(const ReportData& data);

}  // namespace rfmvo::report
