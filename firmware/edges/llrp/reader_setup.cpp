#include "edges/llrp/reader_setup.hpp"

#include <algorithm>
#include <iterator>

#include "edges/llrp/vendor.hpp"

namespace rfmvo::llrp {
namespace {

constexpr std::uint8_t kAllCapabilities = 0, kAllConfiguration = 0;
constexpr std::uint8_t kPeriodicKeepalive = 1;
constexpr std::uint8_t kGen2 = 1;  // AirProtocols
constexpr std::uint8_t kReportEveryNTagsOrEndOfRoSpec = 2;
constexpr std::uint16_t kReportAtOnce = 1;  // N
// Hop, ROSpec, buffer fill warning, exception, AISpec, antenna: LLRP 1.0.1 table of NotificationEventType.
constexpr std::uint16_t kEventTypes[] = {0, 2, 3, 4, 6, 8};
constexpr bool kEventWanted[] = {false, true, true, true, false, true};
constexpr std::uint32_t kDenseM4 = 2;              // Impinj's mode for readers that must cope with others
constexpr std::uint32_t kFirstAutoSetMode = 1000;  // from here on the reader changes the link as it likes
constexpr std::uint16_t kTagPopulation = 32;
constexpr int kCentiPerUnit = 100;

Error cannot(const std::string& what, const std::string& key) { return {ErrorCode::kUnsupported, what, key}; }

template <class Response, class Ask>
Request request(Ask ask, Refusal refusal = Refusal::kFatal) {
  return {Body(std::move(ask)), Response::kName.type, refusal};
}

Result<std::uint16_t> mode_of(const UHFBandCapabilities& band, int wanted) {
  std::vector<std::uint32_t> known;
  for (const auto& table : band.c1g2_uhf_rf_mode_tables)
    for (const auto& entry : table.c1g2_uhf_rf_mode_table_entries) known.push_back(entry.mode_identifier);
  const auto has = [&](std::uint32_t mode) { return std::find(known.begin(), known.end(), mode) != known.end(); };
  if (wanted >= 0 && has(static_cast<std::uint32_t>(wanted))) return static_cast<std::uint16_t>(wanted);
  if (wanted < 0) {
    if (has(kDenseM4)) return static_cast<std::uint16_t>(kDenseM4);
    for (const std::uint32_t mode : known)
      if (mode < kFirstAutoSetMode) return static_cast<std::uint16_t>(mode);
    if (known.empty()) return std::uint16_t{0};
  }
  std::string text;
  for (const std::uint32_t mode : known) text += " " + std::to_string(mode);
  return cannot(wanted < 0 ? "the reader has no fixed mode; it has" + text
                           : "the reader has no mode " + std::to_string(wanted) + "; it has" + text,
                "reader.mode");
}

// Index into the reader's table.
Result<std::uint16_t> power_of(const UHFBandCapabilities& band, double wanted_dbm) {
  const TransmitPowerLevelTableEntry* best = nullptr;
  for (const auto& entry : band.transmit_power_level_table_entries) {
    if (wanted_dbm != 0.0 && entry.transmit_power_value > wanted_dbm * kCentiPerUnit) continue;
    if (best == nullptr || entry.transmit_power_value > best->transmit_power_value) best = &entry;
  }
  if (best == nullptr) return cannot("the reader cannot send with so little power", "reader.power_dbm");
  return best->index;
}

Result<std::vector<std::uint16_t>> antennas_of(const GeneralDeviceCapabilities& device,
                                               const std::vector<std::uint16_t>& wanted) {
  if (wanted.empty()) return std::vector<std::uint16_t>{0};  // all
  for (const std::uint16_t port : wanted)
    if (port < 1 || port > device.max_number_of_antenna_supported)
      return cannot("the reader has no antenna port " + std::to_string(port) + ", but " +
                        std::to_string(device.max_number_of_antenna_supported) + " ports",
                    "reader.antennas");
  return wanted;
}

C1G2InventoryCommand inventory_command(std::uint32_t vendor, std::uint16_t mode, std::uint8_t session) {
  C1G2InventoryCommand command;
  command.c1g2_rf_control = C1G2RFControl{mode, 0};
  command.c1g2_singulation_control.emplace();
  command.c1g2_singulation_control->session = session;
  command.c1g2_singulation_control->tag_population = kTagPopulation;
  if (vendor == kImpinj) command.customs.push_back(pack(ImpinjInventorySearchMode{}));
  if (vendor == kZebra) command.customs.push_back(pack(MotoAntennaConfig{{pack(MotoAntennaQueryConfig{})}}));
  return command;
}

ROReportSpec report_spec(std::uint32_t vendor) {
  ROReportSpec spec;
  spec.ro_report_trigger = kReportEveryNTagsOrEndOfRoSpec;
  spec.n = kReportAtOnce;
  TagReportContentSelector& select = spec.tag_report_content_selector;
  select.enable_antenna_id = select.enable_channel_index = select.enable_peak_rssi = true;
  select.enable_first_seen_timestamp = select.enable_last_seen_timestamp = select.enable_tag_seen_count = true;
  if (vendor == kImpinj)
    spec.customs.push_back(pack(ImpinjTagReportContentSelector{
        {pack(ImpinjEnableRFPhaseAngle{}), pack(ImpinjEnablePeakRSSI{}), pack(ImpinjEnableRFDopplerFrequency{})}}));
  if (vendor == kZebra) spec.customs.push_back(pack(MotoTagReportContentSelector{}));
  return spec;
}

Request event_settings(Duration keepalive) {
  SetReaderConfig set;
  auto& events = set.reader_event_notification_spec.emplace();
  for (std::size_t i = 0; i < std::size(kEventTypes); ++i)
    events.event_notification_states.push_back({kEventTypes[i], kEventWanted[i]});
  set.keepalive_spec = KeepaliveSpec{kPeriodicKeepalive, static_cast<std::uint32_t>(keepalive.ns / 1'000'000)};
  set.events_and_reports = EventsAndReports{false};
  return request<SetReaderConfigResponse>(std::move(set));
}

std::vector<Request> requests_of(const ReaderPlan& plan, const ReaderSettings& settings) {
  std::vector<Request> list;
  if (plan.vendor == kImpinj)
    list.push_back(request<CustomMessage>(CustomMessage{kImpinj, kImpinjEnableExtensions, {0, 0, 0, 0}}));
  list.push_back(request<DisableRoSpecResponse>(DisableRoSpec{{0}}, Refusal::kTolerated));
  list.push_back(request<DeleteRoSpecResponse>(DeleteRoSpec{{0}}, Refusal::kTolerated));
  list.push_back(request<DeleteAccessSpecResponse>(DeleteAccessSpec{0}, Refusal::kTolerated));
  SetReaderConfig reset;
  reset.reset_to_factory_default = true;
  list.push_back(request<SetReaderConfigResponse>(std::move(reset), Refusal::kReported));
  list.push_back(event_settings(settings.keepalive));
  list.push_back(request<AddRoSpecResponse>(AddRoSpec{plan.ro_spec}));
  list.push_back(request<GetRoSpecsResponse>(GetRoSpecs{}, Refusal::kReported));
  list.push_back(request<GetReaderConfigResponse>(GetReaderConfig{0, kAllConfiguration, 0, 0, {}}, Refusal::kReported));
  list.push_back(request<EnableRoSpecResponse>(EnableRoSpec{{kRoSpecId}}));
  list.push_back(request<StartRoSpecResponse>(StartRoSpec{{kRoSpecId}}));
  return list;
}

std::string describe(const GeneralDeviceCapabilities& device, const ChannelTable& channels) {
  return "vendor " + std::to_string(device.device_manufacturer_name) + ", model " + std::to_string(device.model_name) +
         ", firmware " + device.reader_firmware_version + ", " + std::to_string(channels.channels_hz.size()) +
         (channels.hopping ? " channels" : " fixed channels");
}

}  // namespace

Request capabilities_request() {
  return request<GetReaderCapabilitiesResponse>(GetReaderCapabilities{kAllCapabilities, {}});
}

Result<ReaderPlan> plan_reader(const GetReaderCapabilitiesResponse& capabilities, const ReaderSettings& settings) {
  if (!capabilities.general_device_capabilities) return cannot("the reader does not say what it is", "capabilities");
  const GeneralDeviceCapabilities& device = *capabilities.general_device_capabilities;
  auto channels = channel_table(capabilities, settings.hop_table_id);
  if (!channels) return channels.error();
  const UHFBandCapabilities& band = *capabilities.regulatory_capabilities->uhf_band_capabilities;
  const auto mode = mode_of(band, settings.mode);
  if (!mode) return mode.error();
  const auto power = power_of(band, settings.power_dbm);
  if (!power) return power.error();
  const auto antennas = antennas_of(device, settings.antennas);
  if (!antennas) return antennas.error();

  ReaderPlan plan;
  plan.vendor = device.device_manufacturer_name;
  plan.channels = std::move(channels).value();
  plan.description = describe(device, plan.channels);
  // A channel index of 1 is ignored by readers that hop.
  const RFTransmitter transmitter{plan.channels.hop_table_id, std::max<std::uint16_t>(settings.channel_index, 1),
                                  power.value()};
  AntennaConfiguration antenna;
  antenna.rf_transmitter = transmitter;
  antenna.c1g2_inventory_commands = {inventory_command(plan.vendor, mode.value(), settings.session)};
  InventoryParameterSpec inventory{1, kGen2, {}, {}};
  for (const std::uint16_t port : antennas.value()) {
    antenna.antenna_id = port;
    inventory.antenna_configurations.push_back(antenna);
  }
  AISpec ai_spec;
  ai_spec.antenna_ids = antennas.value();
  ai_spec.inventory_parameter_specs = {std::move(inventory)};
  plan.ro_spec.ro_spec_id = kRoSpecId;
  plan.ro_spec.spec_parameters.emplace_back(std::move(ai_spec));
  plan.ro_spec.ro_report_spec = report_spec(plan.vendor);
  plan.requests = requests_of(plan, settings);
  return plan;
}

std::vector<Request> goodbye_requests() {
  return {request<StopRoSpecResponse>(StopRoSpec{{kRoSpecId}}, Refusal::kTolerated),
          request<DisableRoSpecResponse>(DisableRoSpec{{kRoSpecId}}, Refusal::kTolerated),
          request<DeleteRoSpecResponse>(DeleteRoSpec{{kRoSpecId}}, Refusal::kTolerated),
          request<CloseConnectionResponse>(CloseConnection{}, Refusal::kTolerated)};
}

}  // namespace rfmvo::llrp
