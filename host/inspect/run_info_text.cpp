#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "config/config_table.hpp"
#include "inspect/run_info.hpp"

namespace rfmvo::inspect {
namespace {

using Json = nlohmann::ordered_json;

std::string utc(std::int64_t us) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::gmtime(static_cast<std::time_t>(us / 1'000'000)));
}

std::string size_text(std::uint64_t bytes) {
  constexpr double kStep = 1000.0;
  double size = static_cast<double>(bytes);
  for (const char* unit : {"B", "kB", "MB"}) {
    if (size < kStep) return fmt::format("{:.{}f} {}", size, size < 10.0 && *unit != 'B' ? 1 : 0, unit);
    size /= kStep;
  }
  return fmt::format("{:.1f} GB", size);
}

// Settings that are not the defaults.
std::vector<std::pair<std::string, ConfigValue>> changed(const Config& config) {
  std::vector<std::pair<std::string, ConfigValue>> rows;
  const Config defaults;
  for (const ConfigRow& row : config_rows())
    if (const ConfigValue value = get_value(config, row); value != get_value(defaults, row))
      rows.emplace_back(row.key, value);
  return rows;
}

std::string channel_rows(const RunInfo& info) {
  std::string text = fmt::format("{:<22} {:<16} {:>9} {:>8} {:>12} {:>10} {:>10} {:>6}\n", "channel", "type",
                                 "messages", "Hz", "longest gap", "at", "size", "lost");
  for (const auto& [name, c] : info.channels) {
    const bool gap = c.longest_gap_s > 0.0;
    const double at_s = static_cast<double>(c.longest_gap_at_us - info.first_us) * 1e-6;
    text += fmt::format("{:<22} {:<16} {:>9} {:>8} {:>12} {:>10} {:>10} {:>6}\n", name, c.type.empty() ? "?" : c.type,
                        c.messages, c.rate_hz() > 0.0 ? fmt::format("{:.2f}", c.rate_hz()) : "-",
                        gap ? fmt::format("{:.3f} s", c.longest_gap_s) : "-", gap ? fmt::format("{:.2f} s", at_s) : "-",
                        size_text(c.bytes), c.lost ? std::to_string(*c.lost) : "-");
  }
  return text;
}

std::string fault_rows(const RunInfo& info) {
  constexpr std::size_t kMaxShown = 10;
  if (info.faults.empty()) return "faults        none\n";
  std::string text = fmt::format("faults        {}\n", info.faults.size());
  for (std::size_t i = 0; i < std::min(info.faults.size(), kMaxShown); ++i) {
    const Fault& fault = info.faults[i];
    text += fmt::format("  {:9.3f} s  {}: {}\n", static_cast<double>(fault.time.us() - info.first_us) * 1e-6,
                        fault.source, fault.text);
  }
  if (info.faults.size() > kMaxShown) text += fmt::format("  and {} more\n", info.faults.size() - kMaxShown);
  return text;
}

std::string calibration_rows(const Calibration& calibration) {
  const CameraModel& c = calibration.camera;
  std::string text =
      fmt::format("camera        {} x {} px, f {:.1f} {:.1f} px, c {:.1f} {:.1f} px, {}\n", c.width_px, c.height_px,
                  c.fx_px, c.fy_px, c.cx_px, c.cy_px, c.distortion == Distortion::kRadtan ? "radtan" : "equidistant");
  for (const AntennaCalibration& a : calibration.antennas)
    text += fmt::format("antenna {}     at {:.3f} {:.3f} {:.3f} m of the camera (x right, y down, z forward)\n", a.port,
                        a.p_C_A_m.x(), a.p_C_A_m.y(), a.p_C_A_m.z());
  return text;
}

std::string start_rows(const RunInfo& info) {
  if (!info.start) return "no START: not a journal, and not a result of one\n";
  if (!info.start->content)
    return fmt::format("START         of rfmvo {}, not understood: {}\n", info.start->version, info.start->problem);
  std::string text;
  for (const auto& [key, value] : changed(info.start->content->config))
    text += fmt::format("{}{} = {}\n", text.empty() ? "settings      " : "              ", key,
                        std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
  if (text.empty()) text = "settings      all as by default\n";
  return text + calibration_rows(info.start->content->calibration);
}

Json channel_json(const ChannelInfo& c, std::int64_t first_us) {
  Json json{{"type", c.type},
            {"messages", c.messages},
            {"bytes", c.bytes},
            {"first_utime", c.first_us},
            {"last_utime", c.last_us},
            {"rate_hz", c.rate_hz()},
            {"longest_gap_s", c.longest_gap_s}};
  json["longest_gap_at_s"] =
      c.longest_gap_s > 0.0 ? Json(static_cast<double>(c.longest_gap_at_us - first_us) * 1e-6) : Json(nullptr);
  json["lost"] = c.lost ? Json(*c.lost) : Json(nullptr);
  return json;
}

Json start_json(const StartInfo& start) {
  Json json{{"version", start.version}};
  if (!start.content) {
    json["problem"] = start.problem;
    return json;
  }
  for (const ConfigRow& row : config_rows())
    std::visit([&](const auto& v) { json["config"][std::string(row.key)] = v; }, get_value(start.content->config, row));
  const Calibration& calibration = start.content->calibration;
  const CameraModel& c = calibration.camera;
  json["camera"] = {{"width_px", c.width_px}, {"height_px", c.height_px}, {"fx_px", c.fx_px},
                    {"fy_px", c.fy_px},       {"cx_px", c.cx_px},         {"cy_px", c.cy_px}};
  json["antennas"] = Json::array();
  for (const AntennaCalibration& a : calibration.antennas)
    json["antennas"].push_back({{"port", a.port}, {"p_C_A_m", {a.p_C_A_m.x(), a.p_C_A_m.y(), a.p_C_A_m.z()}}});
  return json;
}

}  // namespace

std::string to_text(const RunInfo& info, const std::string& path) {
  std::string text = fmt::format("{}: {:.3f} s from {} UTC, {} messages, {}", path, info.duration_s(),
                                 utc(info.first_us), info.messages, size_text(info.bytes));
  if (info.start) text += fmt::format(", by rfmvo {}", info.start->version);
  text += "\n\n" + channel_rows(info) + "\n";
  if (info.lost_by_recorder > 0)
    text += fmt::format("lost          {} messages, before they were recorded\n", info.lost_by_recorder);
  if (info.reader)
    text += fmt::format("reader        {} connections, clock known to {:.2g} ms, {} clock steps, {} reports lost\n",
                        info.reader->connections, info.reader->clock_sigma_s * 1e3, info.reader->clock_steps,
                        info.reader->reports_lost);
  return text + fault_rows(info) + start_rows(info);
}

std::string to_json(const RunInfo& info, const std::string& path) {
  Json json{{"file", path},
            {"first_utime", info.first_us},
            {"duration_s", info.duration_s()},
            {"messages", info.messages},
            {"bytes", info.bytes},
            {"lost_by_recorder", info.lost_by_recorder}};
  json["damage"] = info.damage ? Json(info.damage->text()) : Json(nullptr);
  json["channels"] = Json::object();
  for (const auto& [name, channel] : info.channels) json["channels"][name] = channel_json(channel, info.first_us);
  json["faults"] = Json::array();
  for (const Fault& fault : info.faults)
    json["faults"].push_back({{"utime", fault.time.us()}, {"source", fault.source}, {"text", fault.text}});
  if (info.reader)
    json["reader"] = {{"connections", info.reader->connections},
                      {"clock_offset_s", info.reader->clock_offset_s},
                      {"clock_sigma_s", info.reader->clock_sigma_s},
                      {"clock_steps", info.reader->clock_steps},
                      {"reports_lost", info.reader->reports_lost}};
  json["start"] = info.start ? start_json(*info.start) : Json(nullptr);
  // Texts of a foreign log may be no UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace rfmvo::inspect
