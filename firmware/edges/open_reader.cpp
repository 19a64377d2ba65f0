#include "edges/open_reader.hpp"

#include <charconv>
#include <string_view>

#include "edges/llrp/reader_link.hpp"
#ifdef RFMVO_WITH_LTKCPP
#include "edges/ltkcpp/ltkcpp_reader.hpp"
#endif

namespace rfmvo {
namespace {

constexpr std::uint16_t kPlainPort = 5084, kTlsPort = 5085;  // IANA: llrp, encrypted-llrp

Result<std::vector<std::uint16_t>> ports_of(const std::string& text) {
  std::vector<std::uint16_t> ports;
  std::string_view left = text;
  while (!left.empty()) {
    left.remove_prefix(std::min(left.find_first_not_of(' '), left.size()));
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(left.data(), left.data() + left.size(), port);
    left.remove_prefix(static_cast<std::size_t>(end - left.data()));
    const bool more = left.size() > 1 && left.front() == ',';
    if (error != std::errc{} || port < 1 || port > 255 || (!left.empty() && !more))
      return Error{ErrorCode::kMalformed, "expects antenna ports from 1, such as 1,2, not \"" + text + "\"",
                   "reader.antennas"};
    ports.push_back(port);
    if (more) left.remove_prefix(1);
  }
  return ports;
}

Result<llrp::ReaderSettings> settings_of(const ReaderConfig& config, const std::optional<Calibration>& calibration) {
  llrp::ReaderSettings settings;
  auto antennas = ports_of(config.antennas);
  if (!antennas) return antennas.error();
  settings.antennas = std::move(antennas).value();
  if (settings.antennas.empty() && calibration)
    for (const AntennaCalibration& antenna : calibration->antennas) settings.antennas.push_back(antenna.port);
  settings.host = config.address;
  settings.tls = config.tls;
  settings.tls_ca = config.tls_ca;
  settings.port = config.port != 0 ? static_cast<std::uint16_t>(config.port) : config.tls ? kTlsPort : kPlainPort;
  settings.phase_sign = config.phase_sign == "falls" ? llrp::PhaseSign::kFalls : llrp::PhaseSign::kGrows;
  settings.mode = static_cast<int>(config.mode);
  settings.session = static_cast<std::uint8_t>(config.session);
  settings.power_dbm = config.power_dbm;
  settings.hop_table_id = static_cast<std::uint8_t>(config.hop_table);
  settings.channel_index = static_cast<std::uint16_t>(config.channel);
  settings.keepalive = Duration::from_seconds(config.keepalive_s);
  return settings;
}

}  // namespace

Result<std::unique_ptr<Reader>> open_reader(const Config& config, const std::optional<Calibration>& calibration,
                                            DeviceClockFunction clock) {
  auto settings = settings_of(config.reader, calibration);
  if (!settings) return settings.error();
  // Boxes that start together must not knock together.
  const auto seed = static_cast<std::uint64_t>(clock().ns);
  if (config.reader.backend == "ltkcpp") {
#ifdef RFMVO_WITH_LTKCPP
    return ltkcpp::open_ltkcpp_reader(settings.value(), std::move(clock), seed);
#else
    return Error{ErrorCode::kUnsupported, "this program was built without the LLRP Toolkit (RFMVO_WITH_LTKCPP)",
                 "reader.backend"};
#endif
  }
  auto link = llrp::ReaderLink::create(settings.value(), std::move(clock), seed);
  if (!link) return link.error();
  return std::unique_ptr<Reader>(std::move(link).value());
}

}  // namespace rfmvo
