#include "report/report.hpp"

#include <fmt/format.h>

#include "report/html.hpp"
#include "report/page_style.hpp"
#include "report/plots.hpp"
#include "report/sections.hpp"

namespace rfmvo::report {
namespace {

struct Figure {
  const char* heading;
  const char* caption;
  const char* nothing;  // said where there is no plot
  std::optional<Plot> plot;
};

std::string legend_of(const Plot& plot) {
  if (plot.legend.empty()) return "";
  std::string text = "<p class=\"legend\">";
  for (const LegendEntry& entry : plot.legend) {
    text += fmt::format("<span><i style=\"color:{}\">{}</i> {}</span> ", entry.css, entry.symbol, escape(entry.text));
  }
  return text + "</p>\n";
}

Result<std::string> figure_section(const Figure& figure) {
  std::string text = fmt::format("<section><h2>{}</h2>\n", figure.heading);
  if (!figure.plot) return text + fmt::format("<p>{}</p></section>\n", figure.nothing);
  const auto svg = draw(*figure.plot);
  if (!svg) return svg.error();
  return text + fmt::format("<p>{}</p>\n{}{}</section>\n", figure.caption, legend_of(*figure.plot), svg.value());
}

std::string page(const std::string& title, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
      escape(title), kPageStyle, body);
}

}  // namespace

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
