// Reader operations: when, on which antennas, how, and what is reported. LLRP 1.0.1 sections 10.2, 13.1.
// Names are the standard's; one `fields` per parameter serves decoding and encoding (schema.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "edges/llrp/inventory.hpp"

namespace rfmvo::llrp {

struct UTCTimestamp {
  static constexpr Name kName{128, "UTCTimestamp"};
  std::uint64_t microseconds = 0;
  static void fields(auto& v, auto& s) { v.value("Microseconds", s.microseconds); }
};

struct Uptime {
  static constexpr Name kName{129, "Uptime"};
  std::uint64_t microseconds = 0;
  static void fields(auto& v, auto& s) { v.value("Microseconds", s.microseconds); }
};

// Absent: monostate.
using Timestamp = std::variant<std::monostate, UTCTimestamp, Uptime>;

struct PeriodicTriggerValue {
  static constexpr Name kName{180, "PeriodicTriggerValue"};
  std::uint32_t offset = 0;
  std::uint32_t period = 0;
  std::optional<UTCTimestamp> utc_timestamp;
  static void fields(auto& v, auto& s) {
    v.value("Offset", s.offset);
    v.value("Period", s.period);
    v.child(s.utc_timestamp);
  }
};

struct GPITriggerValue {
  static constexpr Name kName{181, "GPITriggerValue"};
  std::uint16_t gpi_port_num = 0;
  bool gpi_event = false;
  std::uint32_t timeout = 0;
  static void fields(auto& v, auto& s) {
    v.value("GPIPortNum", s.gpi_port_num);
    v.bits("GPIEvent", s.gpi_event, 1);
    v.reserved(7);
    v.value("Timeout", s.timeout);
  }
};

struct ROSpecStartTrigger {
  static constexpr Name kName{179, "ROSpecStartTrigger"};
  std::uint8_t ro_spec_start_trigger_type = 0;
  std::optional<PeriodicTriggerValue> periodic_trigger_value;
  std::optional<GPITriggerValue> gpi_trigger_value;
  static void fields(auto& v, auto& s) {
    v.value("ROSpecStartTriggerType", s.ro_spec_start_trigger_type);
    v.child(s.periodic_trigger_value);
    v.child(s.gpi_trigger_value);
  }
};

struct ROSpecStopTrigger {
  static constexpr Name kName{182, "ROSpecStopTrigger"};
  std::uint8_t ro_spec_stop_trigger_type = 0;
  std::uint32_t duration_trigger_value = 0;
  std::optional<GPITriggerValue> gpi_trigger_value;
  static void fields(auto& v, auto& s) {
    v.value("ROSpecStopTriggerType", s.ro_spec_stop_trigger_type);
    v.value("DurationTriggerValue", s.duration_trigger_value);
    v.child(s.gpi_trigger_value);
  }
};

struct ROBoundarySpec {
  static constexpr Name kName{178, "ROBoundarySpec"};
  ROSpecStartTrigger ro_spec_start_trigger;
  ROSpecStopTrigger ro_spec_stop_trigger;
  static void fields(auto& v, auto& s) {
    v.child(s.ro_spec_start_trigger);
    v.child(s.ro_spec_stop_trigger);
  }
};

struct TagObservationTrigger {
  static constexpr Name kName{185, "TagObservationTrigger"};
  std::uint8_t trigger_type = 0;
  std::uint16_t number_of_tags = 0;
  std::uint16_t number_of_attempts = 0;
  std::uint16_t t = 0;
  std::uint32_t timeout = 0;
  static void fields(auto& v, auto& s) {
    v.value("TriggerType", s.trigger_type);
    v.reserved(8);
    v.value("NumberOfTags", s.number_of_tags);
    v.value("NumberOfAttempts", s.number_of_attempts);
    v.value("T", s.t);
    v.value("Timeout", s.timeout);
  }
};

struct AISpecStopTrigger {
  static constexpr Name kName{184, "AISpecStopTrigger"};
  std::uint8_t ai_spec_stop_trigger_type = 0;
  std::uint32_t duration_trigger = 0;
  std::optional<GPITriggerValue> gpi_trigger_value;
  std::optional<TagObservationTrigger> tag_observation_trigger;
  static void fields(auto& v, auto& s) {
    v.value("AISpecStopTriggerType", s.ai_spec_stop_trigger_type);
    v.value("DurationTrigger", s.duration_trigger);
    v.child(s.gpi_trigger_value);
    v.child(s.tag_observation_trigger);
  }
};

struct AISpec {
  static constexpr Name kName{183, "AISpec"};
  std::vector<std::uint16_t> antenna_ids;
  AISpecStopTrigger ai_spec_stop_trigger;
  std::vector<InventoryParameterSpec> inventory_parameter_specs;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.value("AntennaIDs", s.antenna_ids);
    v.child(s.ai_spec_stop_trigger);
    v.child(s.inventory_parameter_specs);
    v.child(s.customs);
  }
};

struct RFSurveySpecStopTrigger {
  static constexpr Name kName{188, "RFSurveySpecStopTrigger"};
  std::uint8_t stop_trigger_type = 0;
  std::uint32_t duration_period = 0;
  std::uint32_t n = 0;
  static void fields(auto& v, auto& s) {
    v.value("StopTriggerType", s.stop_trigger_type);
    v.value("DurationPeriod", s.duration_period);
    v.value("N", s.n);
  }
};

struct RFSurveySpec {
  static constexpr Name kName{187, "RFSurveySpec"};
  std::uint16_t antenna_id = 0;
  std::uint32_t start_frequency = 0;
  std::uint32_t end_frequency = 0;
  RFSurveySpecStopTrigger rf_survey_spec_stop_trigger;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.value("AntennaID", s.antenna_id);
    v.value("StartFrequency", s.start_frequency);
    v.value("EndFrequency", s.end_frequency);
    v.child(s.rf_survey_spec_stop_trigger);
    v.child(s.customs);
  }
};

struct C1G2EPCMemorySelector {
  static constexpr Name kName{348, "C1G2EPCMemorySelector"};
  bool enable_crc = false;
  bool enable_pc_bits = false;
  static void fields(auto& v, auto& s) {
    v.bits("EnableCRC", s.enable_crc, 1);
    v.bits("EnablePCBits", s.enable_pc_bits, 1);
    v.reserved(6);
  }
};

struct TagReportContentSelector {
  static constexpr Name kName{238, "TagReportContentSelector"};
  bool enable_ro_spec_id = false;
  bool enable_spec_index = false;
  bool enable_inventory_parameter_spec_id = false;
  bool enable_antenna_id = false;
  bool enable_channel_index = false;
  bool enable_peak_rssi = false;
  bool enable_first_seen_timestamp = false;
  bool enable_last_seen_timestamp = false;
  bool enable_tag_seen_count = false;
  bool enable_access_spec_id = false;
  std::vector<C1G2EPCMemorySelector> c1g2_epc_memory_selectors;
  static void fields(auto& v, auto& s) {
    v.bits("EnableROSpecID", s.enable_ro_spec_id, 1);
    v.bits("EnableSpecIndex", s.enable_spec_index, 1);
    v.bits("EnableInventoryParameterSpecID", s.enable_inventory_parameter_spec_id, 1);
    v.bits("EnableAntennaID", s.enable_antenna_id, 1);
    v.bits("EnableChannelIndex", s.enable_channel_index, 1);
    v.bits("EnablePeakRSSI", s.enable_peak_rssi, 1);
    v.bits("EnableFirstSeenTimestamp", s.enable_first_seen_timestamp, 1);
    v.bits("EnableLastSeenTimestamp", s.enable_last_seen_timestamp, 1);
    v.bits("EnableTagSeenCount", s.enable_tag_seen_count, 1);
    v.bits("EnableAccessSpecID", s.enable_access_spec_id, 1);
    v.reserved(6);
    v.child(s.c1g2_epc_memory_selectors);
  }
};

struct ROReportSpec {
  static constexpr Name kName{237, "ROReportSpec"};
  std::uint8_t ro_report_trigger = 0;
  std::uint16_t n = 0;
  TagReportContentSelector tag_report_content_selector;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.value("ROReportTrigger", s.ro_report_trigger);
    v.value("N", s.n);
    v.child(s.tag_report_content_selector);
    v.child(s.customs);
  }
};

using SpecParameter = std::variant<AISpec, RFSurveySpec, Custom>;

struct ROSpec {
  static constexpr Name kName{177, "ROSpec"};
  std::uint32_t ro_spec_id = 0;
  std::uint8_t priority = 0;
  std::uint8_t current_state = 0;
  ROBoundarySpec ro_boundary_spec;
  std::vector<SpecParameter> spec_parameters;
  std::optional<ROReportSpec> ro_report_spec;
  static void fields(auto& v, auto& s) {
    v.value("ROSpecID", s.ro_spec_id);
    v.value("Priority", s.priority);
    v.value("CurrentState", s.current_state);
    v.child(s.ro_boundary_spec);
    v.child(s.spec_parameters);
    v.child(s.ro_report_spec);
  }
};

}  // namespace rfmvo::llrp
