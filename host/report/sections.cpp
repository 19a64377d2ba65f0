#include "report/sections.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "report/html.hpp"
#include "rf/epc_uri.hpp"

namespace rfmvo::report {
namespace {

constexpr double kCmPerM = 100.0;
constexpr std::int64_t kNsPerS = 1'000'000'000;

std::string card(const std::string& label, const std::string& value, const std::string& note = "") {
  return fmt::format("<div class=\"card\"><span>{}</span><b>{}</b><small>{}</small></div>\n", escape(label),
                     escape(value), escape(note));
}

std::string cm(const std::optional<double>& m) { return m ? fmt::format("{:.1f} cm", *m * kCmPerM) : "–"; }
std::string percent(const std::optional<double>& v, int digits = 0) {
  return v ? fmt::format("{:.{}f} %", *v * 100.0, digits) : "–";
}

// In steps long enough that the noise of single poses does not count as way.
double path_length_m(const ReportData& data) {
  constexpr double kStep_m = 0.25;
  double sum = 0.0;
  for (const auto& [segment, trajectory] : data.last.trajectories) {
    Eigen::Vector3d from = trajectory.poses.front().T_W_C.t;
    for (const MetricPose& pose : trajectory.poses) {
      const double step = (pose.T_W_C.t - from).norm();
      if (!(step >= kStep_m)) continue;
      sum += step;
      from = pose.T_W_C.t;
    }
  }
  return sum;
}

std::string scale_card(const ReportData& data) {
  if (data.last.scales.empty()) return card("Scale", "–", "no scale was estimated");
  const ScaleEstimate& scale = data.last.scales.rbegin()->second;
  if (!scale.observable) return card("Scale", "–", "not observable");
  return card("Scale", fmt::format("{:.4f}", scale.m_per_unit),
              fmt::format("m per unit, ± {:.2f} % (1 σ)", scale.log_sigma * 100.0));
}

const char* class_of(TagStatus status) {
  switch (status) {
    case TagStatus::kConverged:
      return "good";
    case TagStatus::kCircle:
    case TagStatus::kMirror:
    case TagStatus::kWeakGeometry:
      return "doubt";
    case TagStatus::kMoved:
    case TagStatus::kStale:
      return "stale";
    case TagStatus::kNoScale:
    case TagStatus::kTooFewReads:
      return "";
  }
  return "";
}

const evaluate::TagEvaluation* evaluation_of(const ReportData& data, const Epc& epc) {
  if (!data.evaluation) return nullptr;
  for (const auto& tag : data.evaluation->tags.tags) {
    if (tag.epc == epc) return &tag;
  }
  return nullptr;
}

std::string cell(const std::string& text) { return "<td>" + text + "</td>"; }

std::string error_cells(const ReportData& data, const Epc& epc) {
  if (!data.evaluation) return "";
  const auto* tag = evaluation_of(data, epc);
  const auto number = [](const std::optional<double>& m) { return m ? fmt::format("{:.1f}", *m * kCmPerM) : "–"; };
  if (tag == nullptr) return cell("–") + cell("–");
  return cell(number(tag->error_m)) + cell(number(tag->camera_relative_error_m));
}

// The hex, and what GS1 reads in it.
std::string epc_text(const Epc& epc) {
  const auto uri = epc_tag_uri(epc);
  return escape(epc.hex()) + (uri ? "<br><small>" + escape(*uri) + "</small>" : "");
}

std::string tag_row(const ReportData& data, std::size_t index) {
  const TagEstimate& tag = data.tags[index];
  std::string row = fmt::format(
      "<tr><td>{}</td><td class=\"text epc\">{}</td><td class=\"text\"><span class=\"badge {}\">{}</span></td>",
      index + 1, epc_text(tag.epc), class_of(tag.status), evaluate::label_of(tag.status));
  if (evaluate::is_located(tag)) {
    const Eigen::Vector3d sigma = kCmPerM * evaluate::sigma_of(tag.covariance_m2);
    for (int i = 0; i < 3; ++i) row += cell(fmt::format("{:.3f}", tag.p_W_X_m[i]));
    for (int i = 0; i < 3; ++i) row += cell(fmt::format("{:.1f}", sigma[i]));
    row += cell(fmt::format("{}", std::max<std::size_t>(1, tag.hypotheses.size())));
    row += cell(tag.hdop > 0.0 ? fmt::format("{:.2f}", tag.hdop) : "–");
  } else {
    for (int i = 0; i < 8; ++i) row += cell("–");
  }
  row += cell(fmt::format("{}", tag.reads)) + error_cells(data, tag.epc);
  return row + "</tr>\n";
}

// Tags of the truth that were never reported belong into the table, too.
std::string unseen_rows(const ReportData& data) {
  std::string rows;
  if (!data.evaluation) return rows;
  for (const auto& tag : data.evaluation->tags.tags) {
    if (tag.estimate) continue;
    rows += fmt::format(
        "<tr><td></td><td class=\"text epc\">{}</td><td class=\"text\"><span class=\"badge bad\">NOT_SEEN</span></td>",
        epc_text(tag.epc));
    for (int i = 0; i < 8; ++i) rows += cell("–");
    rows += cell("0") + cell("–") + cell("–") + "</tr>\n";
  }
  return rows;
}

}  // namespace

std::string header_section(const ReportData& data) {
  std::string text = fmt::format("<header><h1>{}</h1>\n", escape(data.name));
  if (data.start.ns > 0) {
    const std::time_t start = static_cast<std::time_t>(data.start.ns / kNsPerS);
    text += fmt::format("<p>From {:%Y-%m-%d %H:%M:%S} UTC, {:.1f} s.", fmt::gmtime(start), data.duration.seconds());
  } else {
    text += fmt::format("<p>{:.1f} s.", data.duration.seconds());
  }
  text += " Positions in metres: x forward, y left, z up, from where the cart started.";
  if (data.evaluation) text += " The truth is aligned with the camera path.";
  return text + "</p></header>\n";
}

std::string summary_cards(const ReportData& data) {
  const auto located = std::count_if(data.tags.begin(), data.tags.end(), evaluate::is_located);
  const auto certain = std::count_if(data.tags.begin(), data.tags.end(),
                                     [](const TagEstimate& t) { return t.status == TagStatus::kConverged; });
  std::string cards = "<div class=\"cards\">\n";
  const std::size_t total = data.evaluation ? data.evaluation->tags.tags.size() : data.tags.size();
  const auto located_true = data.evaluation ? data.evaluation->tags.located : static_cast<int>(located);
  cards += card("Tags located", fmt::format("{} of {}", located_true, total), fmt::format("{} converged", certain));
  cards += scale_card(data);
  const double path_m = path_length_m(data);
  cards += card("Camera path", path_m > 0.0 ? fmt::format("{:.2f} m", path_m) : "–",
                data.evaluation ? fmt::format("true: {:.2f} m", data.evaluation->trajectory.path_m) : "");
  if (data.evaluation) {
    const auto& e = *data.evaluation;
    const auto mean = [](const std::optional<evaluate::Summary>& s) {
      return s ? std::optional(s->mean) : std::nullopt;
    };
    cards += card("Tag error", cm(mean(e.tags.error_m)), "mean, in the world");
    cards += card("Tag error to camera", cm(mean(e.tags.camera_relative_m)), "mean, at the closest approach");
    cards += card("Inside 95 % ellipsoid", percent(e.tags.coverage95), "of the located tags; 95 % is honest");
    cards += card("Scale error", percent(e.scale.relative_error, 2), "of the path");
    cards += card("Path error", cm(e.trajectory.ate_se3_m), "RMS after rigid alignment");
  }
  return cards + "</div>\n";
}

std::string tag_table(const ReportData& data) {
  std::string text =
      "<section class=\"long\"><h2>Tags</h2>\n<p>The numbers are those on the maps. σ: one standard deviation of the "
      "position shown. Fits: positions that fit the reads.</p>\n<div class=\"scroll\"><table><thead><tr><th>#</th>"
      "<th class=\"text\">EPC</th><th class=\"text\">Status</th><th>x (m)</th><th>y (m)</th><th>z (m)</th><th>σx "
      "(cm)</th>"
      "<th>σy (cm)</th><th>σz (cm)</th><th>Fits</th><th>HDOP</th><th>Reads</th>";
  if (data.evaluation) text += "<th>Error (cm)</th><th>To cam. (cm)</th>";
  text += "</tr></thead><tbody>\n";
  for (std::size_t i = 0; i < data.tags.size(); ++i) text += tag_row(data, i);
  text += unseen_rows(data);
  return text + "</tbody></table></div></section>\n";
}

std::string health_table(const ReportData& data) {
  std::string text = "<section><h2>Health</h2>\n";
  if (!data.last.health) return text + "<p>The result holds no health report.</p></section>\n";
  const Health& h = *data.last.health;
  const auto row = [&](const char* name, const std::string& value) {
    text += fmt::format("<tr><td class=\"text\">{}</td><td class=\"text\">{}</td></tr>\n", name, escape(value));
  };
  text += "<table><tbody>\n";
  row("Visual odometry",
      fmt::format("{}, {} inliers, segment {}", evaluate::label_of(h.vo_status), h.inliers, h.segment));
  row("Frames, camera poses", fmt::format("{}, {}", h.frames, h.poses));
  row("Tag reads",
      fmt::format("{}; {} without a camera pose, {} rejected", h.reads, h.reads_without_pose, h.reads_rejected));
  if (h.reader.connections > 0)
    row("Reader", fmt::format("{} connections; clock {:.6f} s behind this box's, 1 sigma {:.2g} ms, drift {:.1f} ppm, "
                              "{} steps; {} reports lost",
                              h.reader.connections, h.reader.clock_offset_s, h.reader.clock_sigma_s * 1e3,
                              h.reader.clock_drift * 1e6, h.reader.clock_steps, h.reader.reports_lost));
  row("Tags", fmt::format("{} seen, {} located", h.tags, h.tags_located));
  row("Faults", h.faults == 0 ? "none" : fmt::format("{}; the last: {}", h.faults, h.last_fault));
  return text + "</tbody></table></section>\n";
}

}  // namespace rfmvo::report
