// What the simulated reader says of itself: modelled on an R420's answer, shortened where tables repeat.
#include "edges/llrp/vendor.hpp"
#include "reader_sim/simulated_reader.hpp"

namespace rfmvo::reader_sim {

using namespace llrp;

namespace {

constexpr std::uint32_t kR420 = 2'001'002;
constexpr const char* kFirmware = "6.4.1.240";
constexpr std::uint16_t kAustralia = 36;       // ISO 3166
constexpr std::uint16_t kAustraliaLipd4w = 5;  // CommunicationsStandard
constexpr std::uint8_t kGen2 = 1;              // AirProtocols
constexpr std::int16_t kLeastPower_cdbm = 1000, kPowerStep_cdbm = 25;
constexpr std::uint16_t kPowers = 81;  // to 30 dBm
constexpr std::uint32_t kModes[] = {0, 1, 2, 3, 4, 1000, 1002, 1003, 1004};

GeneralDeviceCapabilities device(const ReaderModel& model) {
  GeneralDeviceCapabilities device;
  device.max_number_of_antenna_supported = model.antennas;
  device.has_utc_clock_capability = !model.troubles.uptime_only;
  device.device_manufacturer_name = kImpinj;
  device.model_name = kR420;
  device.reader_firmware_version = kFirmware;
  device.receive_sensitivity_table_entries = {{1, 0}};
  device.gpio_capabilities = {4, 4};
  for (std::uint16_t port = 1; port <= model.antennas; ++port)
    device.per_antenna_air_protocols.push_back({port, {kGen2}});
  return device;
}

UHFBandCapabilities band(const ReaderModel& model) {
  UHFBandCapabilities band;
  for (std::uint16_t i = 1; i <= kPowers; ++i)
    band.transmit_power_level_table_entries.push_back(
        {i, static_cast<std::int16_t>(kLeastPower_cdbm + (i - 1) * kPowerStep_cdbm)});
  band.frequency_information.hopping = true;
  band.frequency_information.frequency_hop_tables = {{1, model.channels_khz}};
  C1G2UHFRFModeTable& table = band.c1g2_uhf_rf_mode_tables.emplace_back();
  for (const std::uint32_t mode : kModes) {
    C1G2UHFRFModeTableEntry& entry = table.c1g2_uhf_rf_mode_table_entries.emplace_back();
    entry.mode_identifier = mode;
    entry.bdr_value = 640'000;
    entry.pie_value = 1500;
    entry.min_tari_value = entry.max_tari_value = 6250;
  }
  return band;
}

}  // namespace

GetReaderCapabilitiesResponse capabilities_of(const ReaderModel& model) {
  GetReaderCapabilitiesResponse response;
  response.general_device_capabilities = device(model);
  LLRPCapabilities& llrp = response.llrp_capabilities.emplace();
  llrp.can_report_buffer_fill_warning = true;
  llrp.max_num_priority_levels_supported = 1;
  llrp.max_num_ro_specs = 1;
  llrp.max_num_specs_per_ro_spec = 32;
  llrp.max_num_inventory_parameter_specs_per_ai_spec = 1;
  llrp.max_num_access_specs = 1508;
  llrp.max_num_op_specs_per_access_spec = 8;
  RegulatoryCapabilities& regulatory = response.regulatory_capabilities.emplace();
  regulatory.country_code = kAustralia;
  regulatory.communications_standard = kAustraliaLipd4w;
  regulatory.uhf_band_capabilities = band(model);
  response.c1g2_llrp_capabilities.emplace();
  return response;
}

}  // namespace rfmvo::reader_sim
