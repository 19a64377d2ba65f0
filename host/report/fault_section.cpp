#include <fmt/format.h>

#include <cmath>

#include "report/html.hpp"
#include "report/sections.hpp"

namespace rfmvo::report {

std::string fault_table(const ReportData& data) {
  constexpr std::size_t kMaxShown = 200;
  std::string text = "<section class=\"long\"><h2>Faults</h2>\n";
  if (data.faults.empty()) return text + "<p>None was reported.</p></section>\n";
  text +=
      "<table><thead><tr><th>Time (s)</th><th class=\"text\">Source</th><th "
      "class=\"text\">What</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < std::min(data.faults.size(), kMaxShown); ++i) {
    const Fault& fault = data.faults[i];
    text += fmt::format("<tr><td>{:.3f}</td><td class=\"text\">{}</td><td class=\"text\">{}</td></tr>\n",
                        (fault.time - data.start).seconds(), escape(fault.source), escape(fault.text));
  }
  text += "</tbody></table>\n";
  if (data.faults.size() > kMaxShown) text += fmt::format("<p>and {} more</p>\n", data.faults.size() - kMaxShown);
  return text + "</section>\n";
}

std::string residual_caption(const ReportData& data) {
  std::string text =
      "What path, positions and constant offsets do not explain: multipath, the antennas' patterns, noise.";
  if (!data.journal) return text;
  double squares = 0.0;
  std::size_t count = 0;
  for (const ReadPoint& read : data.journal->reads) {
    if (!read.residual_rad) continue;
    squares += *read.residual_rad * *read.residual_rad;
    ++count;
  }
  if (count == 0) return text;
  return text + fmt::format(" RMS {:.2f} rad over {} reads.", std::sqrt(squares / static_cast<double>(count)), count);
}

}  // namespace rfmvo::report
