#include "reproduce/page.hpp"

#include <fmt/format.h>

#include "report/html.hpp"
#include "report/page.hpp"
#include "reproduce/figures.hpp"
#include "reproduce/reasons.hpp"
#include "reproduce/summary.hpp"

namespace rfmvo::reproduce {
namespace {

using report::escape;

std::string header(const Results& results) {
  return fmt::format(
      "<header><h1>RF-MVO, reproduced</h1>\n<p>The evaluation of “RF-MVO: Simultaneous 3D Object Localization and "
      "Camera "
      "Trajectory Recovery Using RFID Devices and a 2D Monocular Camera” on {} simulated runs past its wall ({} tags "
      "in "
      "all): two antennas, 0.3 rad of structured phase error, an odometry that drifts, a cart that weaves. Published "
      "numbers are of other hardware in another room; they are here to be compared with, not to be met.</p></header>\n",
      results.wall.runs.size(), all_tags(results.wall));
}

std::string value_cell(const std::optional<double>& value, int digits) {
  return value ? fmt::format("<td>{:.{}f}</td>", *value, digits) : std::string("<td>–</td>");
}

std::string summary_section(const Study& study, const std::string& heading) {
  std::string text = fmt::format("<section><h2>{}</h2>\n<div class=\"scroll\"><table><thead><tr>", escape(heading));
  text += "<th class=\"text\">Quantity</th><th class=\"text\">Unit</th><th>Published</th>";
  for (const char* title : kColumnTitles) text += fmt::format("<th>{}</th>", escape(title));
  text += "</tr></thead><tbody>\n";
  for (const SummaryRow& row : summary_of(study)) {
    text += fmt::format("<tr><td class=\"text\">{}</td><td class=\"text\">{}</td><td>{}</td>", escape(row.quantity),
                        escape(row.unit), row.published.empty() ? "–" : escape(row.published));
    for (const auto& value : row.values) text += value_cell(value, row.digits);
    text += "</tr>\n";
  }
  return text + "</tbody></table></div>\n" +
         "<p>Errors are of the located tags, relative to the camera and in its axes (Eq. (30)): for the paper's "
         "estimator at "
         "the first read of the array of least HDOP, for the joint one at the closest approach. “Repaired”: with the "
         "four "
         "repairs of docs/paper.md. Tagoram and MobiTagbot are given the true path and a region of 60 × 60 × 25 cm "
         "around "
         "the true tag; the others are given neither.</p></section>\n";
}

std::string time_text(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.1f} µs", 1e6 * seconds);
  if (seconds < 1.0) return fmt::format("{:.2f} ms", 1e3 * seconds);
  return fmt::format("{:.2f} s", seconds);
}

std::string run_times_section(const std::vector<RunTime>& times) {
  std::string text =
      "<section><h2>Run times</h2>\n<p>One core of this machine; published: MATLAB on a 2.3 GHz laptop.</p>\n<div "
      "class=\"scroll\"><table><thead><tr><th class=\"text\">What</th><th>Published</th><th>Here</th></tr></thead>"
      "<tbody>\n";
  for (const RunTime& time : times)
    text += fmt::format("<tr><td class=\"text\">{}</td><td>{}</td><td>{}</td></tr>\n", escape(time.what),
                        time.paper.empty() ? "–" : escape(time.paper), time_text(time.measured_s));
  return text + "</tbody></table></div></section>\n";
}

Status add_figures(const std::vector<FigureData>& figures, std::string& body) {
  for (const FigureData& figure : figures) {
    const auto section = report::figure_section({figure.heading, figure.caption, figure.nothing, plot_of(figure)});
    if (!section) return section.error();
    body += section.value();
  }
  return Done{};
}

}  // namespace

Result<std::string> make_page(const Results& results) {
  std::string body = header(results) + summary_section(results.wall, "Published and measured");
  if (const Status s = add_figures(figures_of(results), body); !s) return s.error();
  body += reasons_section(results) + run_times_section(results.run_times);
  if (results.real_frames) {
    body += summary_section(*results.real_frames,
                            fmt::format("On real frames ({} runs)", results.real_frames->runs.size()));
    if (const Status s = add_figures(real_frame_figures(*results.real_frames), body); !s) return s.error();
  }
  return report::page("RF-MVO, reproduced", body);
}

}  // namespace rfmvo::reproduce
