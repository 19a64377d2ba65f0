#include "reproduce/reasons.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/units.hpp"
#include "evaluate/evaluation.hpp"
#include "report/html.hpp"

namespace rfmvo::reproduce {
namespace {

constexpr double kWavelength_m = 0.325;  // 923 MHz

double median(std::vector<double> values) {
  const auto summary = evaluate::summarise(std::move(values));
  return summary ? summary->median : 0.0;
}

void count(const ArrayResult& array, Fate& fate) {
  const bool answer = array.error_m.has_value();
  if (!array.holds_truth)
    ++fate.truth_excluded;
  else if (!answer)
    ++fate.not_converged;
  else if (*array.error_m > kGood_m)
    ++fate.wrong;
  else
    ++fate.good;
}

std::string table_row(const char* what, std::size_t letter, std::size_t all_letter, std::size_t repaired,
                      std::size_t all_repaired) {
  const auto cell = [](std::size_t n, std::size_t all) {
    return all > 0 ? fmt::format("<td>{}</td><td>{:.0f} %</td>", n,
                                 100.0 * static_cast<double>(n) / static_cast<double>(all))
                   : fmt::format("<td>{}</td><td>–</td>", n);
  };
  return fmt::format("<tr><td class=\"text\">{}</td>{}{}</tr>\n", what, cell(letter, all_letter),
                     cell(repaired, all_repaired));
}

std::string table_of(const Fate& a, const Fate& b) {
  std::string text =
      "<div class=\"scroll\"><table><thead><tr><th class=\"text\">Of all runs</th><th>to the letter</th><th></th>"
      "<th>repaired</th><th></th></tr></thead><tbody>\n";
  text += table_row("tags", a.tags, 0, b.tags, 0);
  text += table_row("of them with L reads on one antenna", a.tags_with_enough_reads, a.tags, b.tags_with_enough_reads,
                    b.tags);
  text += table_row("antenna arrays", a.due, 0, b.due, 0);
  text += table_row("Eq. (4) and (5) leave no scale at all", a.without_range, a.due, b.without_range, b.due);
  text += table_row("they leave some, but not the true one", a.truth_excluded, a.due, b.truth_excluded, b.due);
  text += table_row("the true one is left; section IV does not converge, or ends out of range", a.not_converged, a.due,
                    b.not_converged, b.due);
  text += table_row("it converges, more than 15 cm off", a.wrong, a.due, b.wrong, b.due);
  text += table_row("it converges, within 15 cm", a.good, a.due, b.good, b.due);
  return text + "</tbody></table></div>\n";
}

std::string causes_of(const Fate& fate) {
  std::string text = "<ol>\n";
  const auto item = [&](const std::string& sentence) { text += "<li>" + sentence + "</li>\n"; };
  if (fate.travel_m > 0.0)
    item(
        fmt::format("<b>One direction for a whole array.</b> An array of L reads takes {:.1f} s here and {:.1f} m of "
                    "path (medians), "
                    "past a tag at {:.1f} m. Eq. (1) has one direction for all of it; the wavefront's curvature makes "
                    "{:.0f} rad at "
                    "the ends. A slower cart would make it flat, and with it the range unobservable.",
                    fate.span_s, fate.travel_m, fate.distance_m, fate.curvature_rad));
  item(
      "<b>Scale and elevation are one unknown.</b> P of Eq. (6) depends on γ and the direction u through γ·u alone. On "
      "a "
      "flat floor γ·cos β is all that it has: every γ above the true γ·cos β gives the same peak with another β. "
      "Eq. (8) takes whichever is best by noise.");
  item(
      "<b>The range of Eq. (4), (5).</b> γ_max is 10 cm over the longest step: one missed read in L, and the truth is "
      "out. γ_min is the largest ratio of a noisy distance to a short step.");
  item(
      "<b>Eq. (22)</b> takes a radial change above λ/4 for every step between λ/4 and λ/2, whichever way it goes: "
      "about "
      "half of these steps get a wrong cycle.");
  item(
      "<b>Eq. (11), (12) never turn.</b> The antennas are 12 to 25 cm from the camera; the cart weaves and turns by "
      "tens "
      "of degrees: 10° on 0.25 m are 4 cm, 1.7 rad.");
  item("<b>Least HDOP</b> picks the array that looks longest, which is also the one whose scale came out too large.");
  item(
      "<b>Phase error is not white.</b> 0.3 rad that stay alike over 8 cm of path: consecutive differences remove "
      "part of it, and all that two antennas know together.");
  return text + "</ol>\n";
}

std::string side_cells(const Condition& condition, const Condition::Side& side) {
  const auto value = [](const std::optional<double>& v, double factor) {
    return v ? fmt::format("<td>{:.1f}</td>", factor * *v) : std::string("<td>–</td>");
  };
  return fmt::format("<td>{} of {}</td><td>{}</td>", side.located, condition.tags, side.good) +
         value(side.tag_error_median_m, 100.0) + value(side.scale_relative_median, 100.0);
}

std::string conditions_table(const Results& results) {
  if (results.conditions.empty()) return "";
  std::string text = fmt::format(
      "<h2>The same, made easier</h2>\n<p>With joint optimization, {} runs: tags located, of them within 15 cm, median "
      "of their errors (cm), median scale error (%).</p>\n<div class=\"scroll\"><table><thead><tr><th "
      "class=\"text\">Wall</th><th>to the letter</th><th>&lt; 15 cm</th><th>cm</th><th>%</th><th>repaired</th><th>&lt; "
      "15 cm</th><th>cm</th><th>%</th></tr></thead><tbody>\n",
      results.sweep_runs);
  for (const Condition& c : results.conditions)
    text += fmt::format("<tr><td class=\"text\">{}</td>{}{}</tr>\n", report::escape(c.name), side_cells(c, c.paper),
                        side_cells(c, c.repaired));
  return text +
         "</tbody></table></div>\n<p>Errors of phase and path are not what stops it: what is left without them are the "
         "plane "
         "wave over a long array (eight tags share the reader's time), and over a short one the range that a plane "
         "wave "
         "does not see.</p>\n";
}

}  // namespace

Fate fate_of(const Study& study, PaperRun Run::*variant) {
  Fate fate;
  std::vector<double> spans_s, travels_m, distances_m;
  for (const Run& run : study.runs) {
    const PaperRun& paper = run.*variant;
    fate.tags += paper.tags;
    fate.tags_with_enough_reads += paper.tags_with_enough_reads;
    fate.due += paper.arrays_due;
    fate.without_range += paper.arrays_without_range;
    for (const ArrayResult& array : paper.arrays) {
      count(array, fate);
      spans_s.push_back(array.span_s);
      travels_m.push_back(array.travel_m);
      distances_m.push_back(array.distance_m);
    }
  }
  fate.span_s = median(std::move(spans_s));
  fate.travel_m = median(std::move(travels_m));
  fate.distance_m = median(std::move(distances_m));
  const double far_m = std::hypot(fate.distance_m, 0.5 * fate.travel_m);
  fate.curvature_rad = 2.0 * kTwoPi / kWavelength_m * (far_m - fate.distance_m);
  return fate;
}

std::string reasons_section(const Results& results) {
  const Fate letter = fate_of(results.wall, &Run::paper), repaired = fate_of(results.wall, &Run::repaired);
  return "<section class=\"long\"><h2>Where the paper's method fails on these runs, and why</h2>\n" +
         table_of(letter, repaired) + causes_of(repaired.travel_m > 0.0 ? repaired : letter) +
         conditions_table(results) + "</section>\n";
}

}  // namespace rfmvo::reproduce
