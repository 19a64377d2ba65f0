#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "evaluate/last_estimates.hpp"
#include "rf/epc_uri.hpp"
#include "status/box_status.hpp"

namespace rfmvo::status {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char *kGood = "\033[32m", *kDoubt = "\033[33m", *kBad = "\033[31m", *kSoft = "\033[2m",
                     *kBold = "\033[1m", *kPlain = "\033[0m";

std::string in(const View& view, const char* colour, const std::string& text) {
  return view.colours ? colour + text + kPlain : text;
}

std::string wellness(const BoxStatus& status, const View& view) {
  const auto problems = status.problems(view.now_ns);
  if (problems.empty()) return in(view, kGood, "well");
  return in(view, kBad, fmt::format("{}", fmt::join(problems, ", ")));
}

std::string scale_text(const BoxStatus& status) {
  if (!status.scale()) return "no scale yet";
  if (!status.scale()->observable) return "scale not observable yet: turn, or weave";
  return fmt::format("scale {:.4f} m per unit ± {:.2f} %", status.scale()->m_per_unit,
                     status.scale()->log_sigma * 100.0);
}

std::string loss_text(const View& view) {
  return view.loss.counted ? fmt::format("{} lost", view.loss.messages) : "loss not counted";
}

std::size_t located(const BoxStatus& status) {
  return static_cast<std::size_t>(std::count_if(status.tags().begin(), status.tags().end(),
                                                [](const auto& tag) { return evaluate::is_located(tag.second); }));
}

const char* colour_of(const TagEstimate& tag) {
  if (tag.status == TagStatus::kConverged) return kGood;
  return evaluate::is_located(tag) ? kDoubt : kSoft;
}

std::string tag_row(const TagEstimate& tag, const View& view) {
  std::string row = fmt::format("{:<26} {}", tag.epc.hex(),
                                in(view, colour_of(tag), fmt::format("{:<14}", evaluate::label_of(tag.status))));
  if (evaluate::is_located(tag)) {
    const Eigen::Vector3d& p = tag.p_W_X_m;
    const Eigen::Vector3d cm = 100.0 * evaluate::sigma_of(tag.covariance_m2);
    row +=
        fmt::format(" {:8.3f} {:8.3f} {:8.3f}   {:6.1f} {:6.1f} {:6.1f}", p.x(), p.y(), p.z(), cm.x(), cm.y(), cm.z());
  } else {
    row += fmt::format(" {:>8} {:>8} {:>8}   {:>6} {:>6} {:>6}", "-", "-", "-", "-", "-", "-");
  }
  return row + fmt::format(" {:7}\n", tag.reads);
}

// The surest first, so that the last rows of a small screen are those that say least.
std::vector<const TagEstimate*> in_order(const BoxStatus& status) {
  std::vector<const TagEstimate*> tags;
  for (const auto& [epc, tag] : status.tags()) tags.push_back(&tag);
  const auto rank = [](const TagEstimate& t) {
    return t.status == TagStatus::kConverged ? 0 : evaluate::is_located(t) ? 1 : 2;
  };
  std::stable_sort(tags.begin(), tags.end(), [&](const auto* a, const auto* b) { return rank(*a) < rank(*b); });
  return tags;
}

std::string health_rows(const Health& h, const BoxStatus& status, const View& view) {
  const Rates rates = status.rates().value_or(Rates{});
  const char* colour = h.vo_status == VoStatus::kTracking ? kGood : h.vo_status == VoStatus::kLost ? kBad : kDoubt;
  std::string text = fmt::format("odometry  {}, {} inliers, segment {}; {:.1f} frames/s, {:.1f} poses/s\n",
                                 in(view, colour, evaluate::label_of(h.vo_status)), h.inliers, h.segment,
                                 rates.frames_hz, rates.poses_hz);
  text += fmt::format("reads     {:.1f}/s, {} in all; {} without a pose, {} rejected\n", rates.reads_hz, h.reads,
                      h.reads_without_pose, h.reads_rejected);
  if (h.reader.time.ns != 0)
    text += fmt::format("reader    {}, {} connections; its clock is known to {:.2g} ms; {} reports lost\n",
                        h.reader.reading ? in(view, kGood, "reading") : in(view, kBad, "not reading"),
                        h.reader.connections, h.reader.clock_sigma_s * 1e3, h.reader.reports_lost);
  text += h.faults == 0
              ? "faults    none\n"
              : fmt::format("faults    {}; the last: {}\n", in(view, kDoubt, std::to_string(h.faults)), h.last_fault);
  return text;
}

}  // namespace

std::string to_screen(const BoxStatus& status, const View& view) {
  std::string text = fmt::format("{} {}\n", in(view, kBold, "box       "), wellness(status, view));
  if (status.health()) text += health_rows(*status.health(), status, view);
  text += fmt::format("scale     {}\n", scale_text(status));
  if (status.pose()) {
    const Eigen::Vector3d& p = status.pose()->T_W_C.t;
    text += fmt::format("camera    at {:.3f} {:.3f} {:.3f} m\n", p.x(), p.y(), p.z());
  }
  text +=
      fmt::format("bus       {} messages, {}{}\n", status.messages(), loss_text(view),
                  status.broken() > 0 ? fmt::format(", {} not understood (another version?)", status.broken()) : "");
  text += fmt::format("tags      {} of {} located\n", located(status), status.tags().size());
  if (status.tags().empty()) return text;
  text += in(view, kSoft,
             fmt::format("\n{:<26} {:<14} {:>8} {:>8} {:>8}   {:>6} {:>6} {:>6} {:>7}\n", "EPC", "status", "x m", "y m",
                         "z m", "σx cm", "σy cm", "σz cm", "reads"));
  const auto tags = in_order(status);
  const std::size_t shown = std::min(tags.size(), view.tag_rows);
  for (std::size_t i = 0; i < shown; ++i) text += tag_row(*tags[i], view);
  if (shown < tags.size()) text += in(view, kSoft, fmt::format("and {} more\n", tags.size() - shown));
  return text;
}

std::string to_line(const BoxStatus& status, const View& view) {
  const std::string well = fmt::format("{}", fmt::join(status.problems(view.now_ns), ", "));
  std::string text = well.empty() ? "well" : well;
  if (status.health()) {
    const Health& h = *status.health();
    const Rates rates = status.rates().value_or(Rates{});
    text += fmt::format("; odometry {}, {} inliers; {:.1f} frames/s, {:.1f} reads/s; {} faults",
                        evaluate::label_of(h.vo_status), h.inliers, rates.frames_hz, rates.reads_hz, h.faults);
  }
  return text + fmt::format("; {} of {} tags located; {}; {}\n", located(status), status.tags().size(),
                            scale_text(status), loss_text(view));
}

std::string to_json(const BoxStatus& status, const View& view) {
  const auto problems = status.problems(view.now_ns);
  Json json{{"well", problems.empty()}, {"problems", problems}};
  json["silence_s"] = status.silence_s(view.now_ns) ? Json(*status.silence_s(view.now_ns)) : Json(nullptr);
  if (status.health()) {
    const Health& h = *status.health();
    json["utime"] = h.time.us();
    json["odometry"] = {{"status", evaluate::label_of(h.vo_status)}, {"inliers", h.inliers}, {"segment", h.segment}};
    json["frames"] = h.frames;
    json["reads"] = h.reads;
    json["reads_without_pose"] = h.reads_without_pose;
    json["reads_rejected"] = h.reads_rejected;
    json["faults"] = h.faults;
    json["last_fault"] = h.last_fault;
    json["reader"] = h.reader.time.ns == 0 ? Json(nullptr)
                                           : Json{{"reading", h.reader.reading},
                                                  {"connections", h.reader.connections},
                                                  {"clock_known", h.reader.clock_known},
                                                  {"clock_sigma_s", h.reader.clock_sigma_s},
                                                  {"reports_lost", h.reader.reports_lost}};
  }
  if (status.rates())
    json["rates"] = {{"frames_hz", status.rates()->frames_hz},
                     {"poses_hz", status.rates()->poses_hz},
                     {"reads_hz", status.rates()->reads_hz}};
  json["scale"] = status.scale() && status.scale()->observable
                      ? Json{{"m_per_unit", status.scale()->m_per_unit}, {"log_sigma", status.scale()->log_sigma}}
                      : Json(nullptr);
  json["bus"] = {{"messages", status.messages()}, {"not_understood", status.broken()}};
  json["bus"]["lost"] = view.loss.counted ? Json(view.loss.messages) : Json(nullptr);
  json["tags"] = Json::array();
  for (const auto& [epc, tag] : status.tags()) {
    Json one{{"epc", epc.hex()}, {"status", evaluate::label_of(tag.status)}, {"reads", tag.reads}};
    if (const auto uri = epc_tag_uri(epc)) one["uri"] = *uri;
    if (evaluate::is_located(tag)) {
      const Eigen::Vector3d sigma = evaluate::sigma_of(tag.covariance_m2);
      one["position_m"] = {tag.p_W_X_m.x(), tag.p_W_X_m.y(), tag.p_W_X_m.z()};
      one["sigma_m"] = {sigma.x(), sigma.y(), sigma.z()};
    }
    json["tags"].push_back(std::move(one));
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace rfmvo::status
