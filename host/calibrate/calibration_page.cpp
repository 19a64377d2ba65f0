#include <fmt/format.h>

#include "base/units.hpp"
#include "calibrate/camera_calibration.hpp"
#include "report/html.hpp"
#include "report/page.hpp"
#include "report/plots.hpp"
#include "report/script.hpp"

namespace rfmvo::calibrate {
namespace {

using namespace report;

constexpr double kMagnified = 100.0;

// Arrows from where each corner was seen, along its error.
Plot error_arrows(const CameraCalibration& c) {
  std::string arrows;
  for (const Residual& r : c.residuals)
    arrows += fmt::format("{:.2f} {:.2f} {:.3f} {:.3f}\n", r.at_px.x, r.at_px.y, kMagnified * r.error_px.x,
                          kMagnified * r.error_px.y);
  Script script;
  script.add({arrows, fmt::format("using 1:2:3:4 with vectors head size 4,20 filled lw 0.8 lc rgb '{}' notitle",
                                  kGood.gnuplot)});
  Plot plot{.name = "arrows",
            .title = "Reprojection errors over the picture",
            .width = 1000,
            .height = 760,
            .script = axes_style(),
            .legend = {}};
  // Pictures count downwards.
  plot.script += fmt::format(
      "set size ratio -1\nset xlabel 'x (px)'\nset ylabel 'y (px)'\nset xrange [0:{}]\n"
      "set yrange [{}:0]\n{}",
      c.camera.width_px, c.camera.height_px, script.text());
  return plot;
}

Plot errors_of_views(const CameraCalibration& c) {
  std::string bars;
  for (std::size_t v = 0; v < c.view_rms_px.size(); ++v) bars += fmt::format("{} {:.4f}\n", v + 1, c.view_rms_px[v]);
  Script script;
  script.add({bars, fmt::format("using 1:2 with boxes fs solid 0.6 lc rgb '{}' notitle", kGood.gnuplot)});
  Plot plot{.name = "views",
            .title = "Reprojection error of each picture",
            .width = 1000,
            .height = 300,
            .script = axes_style(),
            .legend = {}};
  plot.script += "set boxwidth 0.8\nset yrange [0:*]\nset xlabel 'picture'\nset ylabel 'RMS (px)'\n" + script.text();
  return plot;
}

std::string list_of(const std::vector<std::string>& sentences) {
  if (sentences.empty()) return "<p>The pictures are enough.</p>";
  std::string text = "<ul>";
  for (const std::string& sentence : sentences) text += "<li>" + escape(sentence) + "</li>";
  return text + "</ul>";
}

std::string view_table(const CameraCalibration& c) {
  std::string text =
      "<section class=\"long\"><h2>Pictures</h2><table><thead><tr><th>#</th><th class=\"text\">Picture</th>"
      "<th>RMS (px)</th><th>Tilt (°)</th></tr></thead><tbody>";
  for (std::size_t v = 0; v < c.views.size(); ++v)
    text += fmt::format("<tr><td>{}</td><td class=\"text\">{}</td><td>{:.3f}</td><td>{:.0f}</td></tr>", v + 1,
                        escape(c.views[v]), c.view_rms_px[v], deg_from_rad(c.tilt_rad[v]));
  return text + "</tbody></table></section>";
}

}  // namespace

Result<std::string> calibration_page(const CameraCalibration& c) {
  std::string body = fmt::format(
      "<header><h1>Camera calibration</h1><p>{} pictures, {} corners, error {:.3f} px RMS</p>"
      "</header><section><h2>Camera</h2><pre>{}</pre></section><section><h2>What else to take"
      "</h2>{}</section>",
      c.views.size(), c.residuals.size(), c.rms_px, escape(to_kalibr_yaml(c)), list_of(advice(c)));
  const Figure figures[] = {{"Reprojection errors",
                             fmt::format("Arrows are {:.0f} times as long as the errors. Arrows of one neighbourhood "
                                         "that point the same way mean that the lens model does not fit.",
                                         kMagnified),
                             "", error_arrows(c)},
                            {"Error of each picture", "A picture far above the others is blurred, or its board bent.",
                             "", errors_of_views(c)}};
  for (const Figure& figure : figures) {
    const auto section = figure_section(figure);
    if (!section) return section.error();
    body += section.value();
  }
  return page("Camera calibration", body + view_table(c));
}

}  // namespace rfmvo::calibrate
