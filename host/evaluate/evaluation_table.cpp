#include <fmt/format.h>

#include <algorithm>

#include "evaluate/evaluation_text.hpp"
#include "evaluate/last_estimates.hpp"

namespace rfmvo::evaluate {
namespace {

constexpr double kCmPerM = 100.0;

std::string cm(const std::optional<double>& m) { return m ? fmt::format("{:.1f}", *m * kCmPerM) : "-"; }
std::string percent(const std::optional<double>& share, int digits = 0) {
  return share ? fmt::format("{:.{}f} %", *share * 100.0, digits) : "-";
}
std::string number(const std::optional<double>& value) { return value ? fmt::format("{:.2f}", *value) : "-"; }

std::size_t epc_width(const TagsEvaluation& tags) {
  std::size_t width = 3;
  for (const TagEvaluation& tag : tags.tags) width = std::max(width, tag.epc.hex().size());
  return width;
}

std::string row(const TagEvaluation& tag, std::size_t width) {
  const std::string epc = tag.epc.hex();
  if (!tag.estimate) return fmt::format("{:<{}}  {:<13}\n", epc, width, "NOT_SEEN");
  const TagEstimate& e = *tag.estimate;
  if (!tag.located) {
    return fmt::format("{:<{}}  {:<13}  {:>8} {:>8} {:>8}  {:>6} {:>6} {:>6}  {:>7}  {:>7}  {:>6}\n", epc, width,
                       label_of(e.status), "-", "-", "-", "-", "-", "-", "-", "-", e.reads);
  }
  const Eigen::Vector3d sigma = kCmPerM * sigma_of(e.covariance_m2);
  return fmt::format("{:<{}}  {:<13}  {:>8.3f} {:>8.3f} {:>8.3f}  {:>6.1f} {:>6.1f} {:>6.1f}  {:>7}  {:>7}  {:>6}\n",
                     epc, width, label_of(e.status), e.p_W_X_m.x(), e.p_W_X_m.y(), e.p_W_X_m.z(), sigma.x(), sigma.y(),
                     sigma.z(), cm(tag.error_m), cm(tag.camera_relative_error_m), e.reads);
}

std::string tags_summary(const TagsEvaluation& tags) {
  std::string text = fmt::format("tags         {} of {} located", tags.located, tags.total);
  if (!tags.unknown.empty()) text += fmt::format("; {} more that the truth does not know", tags.unknown.size());
  text += '\n';
  const auto line = [&](const char* name, const std::optional<Summary>& s, const std::optional<double>& coverage,
                        const std::optional<double>& nees) {
    if (!s) return;
    text += fmt::format("{:<12} mean {:.1f} cm, median {:.1f}, rms {:.1f}, max {:.1f}; {} inside 95 %, NEES {} (3)\n",
                        name, s->mean * kCmPerM, s->median * kCmPerM, s->rmse * kCmPerM, s->max * kCmPerM,
                        percent(coverage), number(nees));
  };
  line("error", tags.error_m, tags.coverage95_world, tags.nees_world_mean);
  line("to camera", tags.camera_relative_m, tags.coverage95, tags.nees_mean);
  return text;
}

std::string scale_summary(const ScaleEvaluation& scale) {
  std::string text = "scale        ";
  if (!scale.estimate) {
    text += "none";
  } else if (!scale.estimate->observable) {
    text += "not observable";
  } else {
    text += fmt::format("{:.5f} m per unit, 1 sigma {:.2f} %", scale.estimate->m_per_unit,
                        scale.estimate->log_sigma * 100.0);
  }
  if (scale.true_m_per_unit) text += fmt::format("; true {:.5f}", *scale.true_m_per_unit);
  text += fmt::format("\n             error of the path {}; Eq. (31) {}, {} steps\n", percent(scale.relative_error, 2),
                      percent(scale.eq31_relative, 2), scale.eq31_steps);
  return text;
}

}  // namespace

std::string to_table(const Evaluation& evaluation) {
  const std::size_t width = epc_width(evaluation.tags);
  std::string text =
      fmt::format("{:<{}}  {:<13}  {:>8} {:>8} {:>8}  {:>6} {:>6} {:>6}  {:>7}  {:>7}  {:>6}\n", "EPC", width, "status",
                  "x m", "y m", "z m", "sx cm", "sy cm", "sz cm", "err cm", "cam cm", "reads");
  for (const TagEvaluation& tag : evaluation.tags.tags) text += row(tag, width);
  text += '\n' + tags_summary(evaluation.tags) + scale_summary(evaluation.scale);
  const TrajectoryEvaluation& t = evaluation.trajectory;
  text += fmt::format("path         {:.2f} m; ATE {} cm (SE3), {} cm (Sim3)\n", t.path_m, cm(t.ate_se3_m),
                      cm(t.ate_sim3_m));
  for (const SegmentEvaluation& segment : t.segments) {
    if (t.segments.size() == 1 && !segment.aligned_with_orientations) continue;
    text +=
        fmt::format("segment {:<4} {:.2f} m, {} poses, ATE {} cm{}\n", segment.segment, segment.path_m, segment.poses,
                    cm(segment.ate_se3_m),
                    segment.aligned_with_orientations ? "; straight: tags aligned with the camera's orientation" : "");
  }
  return text;
}

}  // namespace rfmvo::evaluate
