#include "report/page.hpp"

#include <fmt/format.h>

#include "report/html.hpp"
#include "report/page_style.hpp"

namespace rfmvo::report {

std::string legend_of(const Plot& plot) {
  if (plot.legend.empty()) return "";
  std::string text = "<p class=\"legend\">";
  for (const LegendEntry& entry : plot.legend) {
    text += fmt::format("<span><i style=\"color:{}\">{}</i> {}</span> ", entry.css, entry.symbol, escape(entry.text));
  }
  return text + "</p>\n";
}

Result<std::string> figure_section(const Figure& figure) {
  std::string text = fmt::format("<section><h2>{}</h2>\n", escape(figure.heading));
  if (!figure.plot) return text + fmt::format("<p>{}</p></section>\n", escape(figure.nothing));
  const auto svg = draw(*figure.plot);
  if (!svg) return svg.error();
  return text +
         fmt::format("<p>{}</p>\n{}{}</section>\n", escape(figure.caption), legend_of(*figure.plot), svg.value());
}

std::string page(const std::string& title, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
      escape(title), kPageStyle, body);
}

}  // namespace rfmvo::report
