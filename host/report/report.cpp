#include "report/report.hpp"

#include "report/page.hpp"
#include "report/plots.hpp"
#include "report/sections.hpp"

namespace rfmvo::report {

Result<std::string> make_report(const std::vector<Estimate>& estimates, const std::optional<simulate::Truth>& truth,
                                const std::string& name) {
  const auto collected = collect(estimates, truth, name);
  if (!collected) return collected.error();
  const ReportData& data = collected.value();

  constexpr const char* kNoMap = "No path and no located tag.";
  const Figure figures[] = {
      {"From above", "Ellipses hold the tag with 95 % probability.", kNoMap, top_view(data)},
      {"From the side", "The same, in height.", kNoMap, side_view(data)},
      {"Scale over time", "Metres per unit of the visual odometry.", "The scale never was observable.",
       scale_over_time(data)},
      {"Certainty of the tags over time", "One standard deviation along the worst axis of each tag.",
       "No tag was located.", tag_sigma_over_time(data)},
  };
  std::string body = header_section(data) + summary_cards(data);
  for (const Figure& figure : figures) {
    const auto section = figure_section(figure);
    if (!section) return section.error();
    body += section.value();
  }
  body += tag_table(data) + health_table(data);
  return page(name, body);
}

}  // namespace rfmvo::report
