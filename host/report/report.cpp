#include "report/report.hpp"

#include "report/page.hpp"
#include "report/plots.hpp"
#include "report/sections.hpp"

namespace rfmvo::report {

Result<std::string> make_report(const std::vector<Estimate>& estimates, const std::optional<simulate::Truth>& truth,
                                const std::string& name, std::optional<JournalData> journal) {
  auto collected = collect(estimates, truth, name);
  if (!collected) return collected.error();
  ReportData data = std::move(collected).value();
  if (journal) data.faults = journal->faults;
  data.journal = std::move(journal);

  constexpr const char* kNoMap = "No path and no located tag.";
  constexpr const char* kNoJournal = "Reads are in the journal: rfmvo report --journal RUN.lcmlog";
  const Figure figures[] = {
      {"From above", "Ellipses hold the tag with 95 % probability.", kNoMap, top_view(data)},
      {"From the side", "The same, in height.", kNoMap, side_view(data)},
      {"In three dimensions",
       "Ellipses are the outlines of the 95 % ellipsoids; lines go down to the height of the start.", kNoMap,
       oblique_view(data)},
      {"Scale over time", "Metres per unit of the visual odometry.", "The scale never was observable.",
       scale_over_time(data)},
      {"Certainty of the tags over time", "One standard deviation along the worst axis of each tag.",
       "No tag was located.", tag_sigma_over_time(data)},
      {"Reads over time", "One row a tag, by its number.", kNoJournal, read_timeline(data)},
      {"Phase residuals", residual_caption(data),
       data.journal ? "No read of a located tag lies on the path." : kNoJournal, phase_residual_plot(data)},
  };
  std::string body = header_section(data) + summary_cards(data);
  for (const Figure& figure : figures) {
    const auto section = figure_section(figure);
    if (!section) return section.error();
    body += section.value();
  }
  body += tag_table(data) + health_table(data) + fault_table(data);
  return page(name, body);
}

}  // namespace rfmvo::report
