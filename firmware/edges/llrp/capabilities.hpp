// What the reader can do: antennas, power and hop tables, RF modes. LLRP 1.0.1 section 10.
// Names are the standard's; one `fields` per parameter serves decoding and encoding (schema.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "edges/llrp/schema.hpp"

namespace rfmvo::llrp {

struct ReceiveSensitivityTableEntry {
  static constexpr Name kName{139, "ReceiveSensitivityTableEntry"};
  std::uint16_t index = 0;
  std::int16_t receive_sensitivity_value = 0;
  static void fields(auto& v, auto& s) {
    v.value("Index", s.index);
    v.value("ReceiveSensitivityValue", s.receive_sensitivity_value);
  }
};

struct PerAntennaReceiveSensitivityRange {
  static constexpr Name kName{149, "PerAntennaReceiveSensitivityRange"};
  std::uint16_t antenna_id = 0;
  std::uint16_t receive_sensitivity_index_min = 0;
  std::uint16_t receive_sensitivity_index_max = 0;
  static void fields(auto& v, auto& s) {
    v.value("AntennaID", s.antenna_id);
    v.value("ReceiveSensitivityIndexMin", s.receive_sensitivity_index_min);
    v.value("ReceiveSensitivityIndexMax", s.receive_sensitivity_index_max);
  }
};

struct PerAntennaAirProtocol {
  static constexpr Name kName{140, "PerAntennaAirProtocol"};
  std::uint16_t antenna_id = 0;
  std::vector<std::uint8_t> protocol_id;
  static void fields(auto& v, auto& s) {
    v.value("AntennaID", s.antenna_id);
    v.value("ProtocolID", s.protocol_id);
  }
};

struct GPIOCapabilities {
  static constexpr Name kName{141, "GPIOCapabilities"};
  std::uint16_t num_gpis = 0;
  std::uint16_t num_gpos = 0;
  static void fields(auto& v, auto& s) {
    v.value("NumGPIs", s.num_gpis);
    v.value("NumGPOs", s.num_gpos);
  }
};

struct GeneralDeviceCapabilities {
  static constexpr Name kName{137, "GeneralDeviceCapabilities"};
  std::uint16_t max_number_of_antenna_supported = 0;
  bool can_set_antenna_properties = false;
  bool has_utc_clock_capability = false;
  std::uint32_t device_manufacturer_name = 0;
  std::uint32_t model_name = 0;
  std::string reader_firmware_version;
  std::vector<ReceiveSensitivityTableEntry> receive_sensitivity_table_entries;
  std::vector<PerAntennaReceiveSensitivityRange> per_antenna_receive_sensitivity_ranges;
  GPIOCapabilities gpio_capabilities;
  std::vector<PerAntennaAirProtocol> per_antenna_air_protocols;
  static void fields(auto& v, auto& s) {
    v.value("MaxNumberOfAntennaSupported", s.max_number_of_antenna_supported);
    v.bits("CanSetAntennaProperties", s.can_set_antenna_properties, 1);
    v.bits("HasUTCClockCapability", s.has_utc_clock_capability, 1);
    v.reserved(14);
    v.value("DeviceManufacturerName", s.device_manufacturer_name);
    v.value("ModelName", s.model_name);
    v.value("ReaderFirmwareVersion", s.reader_firmware_version);
    v.child(s.receive_sensitivity_table_entries);
    v.child(s.per_antenna_receive_sensitivity_ranges);
    v.child(s.gpio_capabilities);
    v.child(s.per_antenna_air_protocols);
  }
};

struct LLRPCapabilities {
  static constexpr Name kName{142, "LLRPCapabilities"};
  bool can_do_rf_survey = false;
  bool can_report_buffer_fill_warning = false;
  bool supports_client_request_op_spec = false;
  bool can_do_tag_inventory_state_aware_singulation = false;
  bool supports_event_and_report_holding = false;
  std::uint8_t max_num_priority_levels_supported = 0;
  std::uint16_t client_request_op_spec_timeout = 0;
  std::uint32_t max_num_ro_specs = 0;
  std::uint32_t max_num_specs_per_ro_spec = 0;
  std::uint32_t max_num_inventory_parameter_specs_per_ai_spec = 0;
  std::uint32_t max_num_access_specs = 0;
  std::uint32_t max_num_op_specs_per_access_spec = 0;
  static void fields(auto& v, auto& s) {
    v.bits("CanDoRFSurvey", s.can_do_rf_survey, 1);
    v.bits("CanReportBufferFillWarning", s.can_report_buffer_fill_warning, 1);
    v.bits("SupportsClientRequestOpSpec", s.supports_client_request_op_spec, 1);
    v.bits("CanDoTagInventoryStateAwareSingulation", s.can_do_tag_inventory_state_aware_singulation, 1);
    v.bits("SupportsEventAndReportHolding", s.supports_event_and_report_holding, 1);
    v.reserved(3);
    v.value("MaxNumPriorityLevelsSupported", s.max_num_priority_levels_supported);
    v.value("ClientRequestOpSpecTimeout", s.client_request_op_spec_timeout);
    v.value("MaxNumROSpecs", s.max_num_ro_specs);
    v.value("MaxNumSpecsPerROSpec", s.max_num_specs_per_ro_spec);
    v.value("MaxNumInventoryParameterSpecsPerAISpec", s.max_num_inventory_parameter_specs_per_ai_spec);
    v.value("MaxNumAccessSpecs", s.max_num_access_specs);
    v.value("MaxNumOpSpecsPerAccessSpec", s.max_num_op_specs_per_access_spec);
  }
};

struct TransmitPowerLevelTableEntry {
  static constexpr Name kName{145, "TransmitPowerLevelTableEntry"};
  std::uint16_t index = 0;
  std::int16_t transmit_power_value = 0;
  static void fields(auto& v, auto& s) {
    v.value("Index", s.index);
    v.value("TransmitPowerValue", s.transmit_power_value);
  }
};

struct FrequencyHopTable {
  static constexpr Name kName{147, "FrequencyHopTable"};
  std::uint8_t hop_table_id = 0;
  std::vector<std::uint32_t> frequency;
  static void fields(auto& v, auto& s) {
    v.value("HopTableID", s.hop_table_id);
    v.reserved(8);
    v.value("Frequency", s.frequency);
  }
};

struct FixedFrequencyTable {
  static constexpr Name kName{148, "FixedFrequencyTable"};
  std::vector<std::uint32_t> frequency;
  static void fields(auto& v, auto& s) { v.value("Frequency", s.frequency); }
};

struct FrequencyInformation {
  static constexpr Name kName{146, "FrequencyInformation"};
  bool hopping = false;
  std::vector<FrequencyHopTable> frequency_hop_tables;
  std::optional<FixedFrequencyTable> fixed_frequency_table;
  static void fields(auto& v, auto& s) {
    v.bits("Hopping", s.hopping, 1);
    v.reserved(7);
    v.child(s.frequency_hop_tables);
    v.child(s.fixed_frequency_table);
  }
};

struct C1G2UHFRFModeTableEntry {
  static constexpr Name kName{329, "C1G2UHFRFModeTableEntry"};
  std::uint32_t mode_identifier = 0;
  bool dr_value = false;
  bool epc_hag_tc_conformance = false;
  std::uint8_t m_value = 0;
  std::uint8_t forward_link_modulation = 0;
  std::uint8_t spectral_mask_indicator = 0;
  std::uint32_t bdr_value = 0;
  std::uint32_t pie_value = 0;
  std::uint32_t min_tari_value = 0;
  std::uint32_t max_tari_value = 0;
  std::uint32_t step_tari_value = 0;
  static void fields(auto& v, auto& s) {
    v.value("ModeIdentifier", s.mode_identifier);
    v.bits("DRValue", s.dr_value, 1);
    v.bits("EPCHAGTCConformance", s.epc_hag_tc_conformance, 1);
    v.reserved(6);
    v.value("MValue", s.m_value);
    v.value("ForwardLinkModulation", s.forward_link_modulation);
    v.value("SpectralMaskIndicator", s.spectral_mask_indicator);
    v.value("BDRValue", s.bdr_value);
    v.value("PIEValue", s.pie_value);
    v.value("MinTariValue", s.min_tari_value);
    v.value("MaxTariValue", s.max_tari_value);
    v.value("StepTariValue", s.step_tari_value);
  }
};

struct C1G2UHFRFModeTable {
  static constexpr Name kName{328, "C1G2UHFRFModeTable"};
  std::vector<C1G2UHFRFModeTableEntry> c1g2_uhf_rf_mode_table_entries;
  static void fields(auto& v, auto& s) { v.child(s.c1g2_uhf_rf_mode_table_entries); }
};

struct UHFBandCapabilities {
  static constexpr Name kName{144, "UHFBandCapabilities"};
  std::vector<TransmitPowerLevelTableEntry> transmit_power_level_table_entries;
  FrequencyInformation frequency_information;
  std::vector<C1G2UHFRFModeTable> c1g2_uhf_rf_mode_tables;
  static void fields(auto& v, auto& s) {
    v.child(s.transmit_power_level_table_entries);
    v.child(s.frequency_information);
    v.child(s.c1g2_uhf_rf_mode_tables);
  }
};

struct RegulatoryCapabilities {
  static constexpr Name kName{143, "RegulatoryCapabilities"};
  std::uint16_t country_code = 0;
  std::uint16_t communications_standard = 0;
  std::optional<UHFBandCapabilities> uhf_band_capabilities;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.value("CountryCode", s.country_code);
    v.value("CommunicationsStandard", s.communications_standard);
    v.child(s.uhf_band_capabilities);
    v.child(s.customs);
  }
};

struct C1G2LLRPCapabilities {
  static constexpr Name kName{327, "C1G2LLRPCapabilities"};
  bool can_support_block_erase = false;
  bool can_support_block_write = false;
  std::uint16_t max_num_select_filters_per_query = 0;
  static void fields(auto& v, auto& s) {
    v.bits("CanSupportBlockErase", s.can_support_block_erase, 1);
    v.bits("CanSupportBlockWrite", s.can_support_block_write, 1);
    v.reserved(6);
    v.value("MaxNumSelectFiltersPerQuery", s.max_num_select_filters_per_query);
  }
};

}  // namespace rfmvo::llrp
