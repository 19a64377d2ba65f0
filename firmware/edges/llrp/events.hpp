// Events of the reader. LLRP 1.0.1 section 13.2.6.
// Names are the standard's; one `fields` per parameter serves decoding and encoding (schema.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "edges/llrp/report.hpp"
#include "edges/llrp/rospec.hpp"

namespace rfmvo::llrp {

struct HoppingEvent {
  static constexpr Name kName{247, "HoppingEvent"};
  std::uint16_t hop_table_id = 0;
  std::uint16_t next_channel_index = 0;
  static void fields(auto& v, auto& s) {
    v.value("HopTableID", s.hop_table_id);
    v.value("NextChannelIndex", s.next_channel_index);
  }
};

struct GPIEvent {
  static constexpr Name kName{248, "GPIEvent"};
  std::uint16_t gpi_port_number = 0;
  bool gpi_event = false;
  static void fields(auto& v, auto& s) {
    v.value("GPIPortNumber", s.gpi_port_number);
    v.bits("GPIEvent", s.gpi_event, 1);
    v.reserved(7);
  }
};

struct ROSpecEvent {
  static constexpr Name kName{249, "ROSpecEvent"};
  std::uint8_t event_type = 0;
  std::uint32_t ro_spec_id = 0;
  std::uint32_t preempting_ro_spec_id = 0;
  static void fields(auto& v, auto& s) {
    v.value("EventType", s.event_type);
    v.value("ROSpecID", s.ro_spec_id);
    v.value("PreemptingROSpecID", s.preempting_ro_spec_id);
  }
};

struct ReportBufferLevelWarningEvent {
  static constexpr Name kName{250, "ReportBufferLevelWarningEvent"};
  std::uint8_t report_buffer_percentage_full = 0;
  static void fields(auto& v, auto& s) { v.value("ReportBufferPercentageFull", s.report_buffer_percentage_full); }
};

struct ReportBufferOverflowErrorEvent {
  static constexpr Name kName{251, "ReportBufferOverflowErrorEvent"};
  static void fields(auto&, auto&) {}
};

struct OpSpecID {
  static constexpr Name kName{17, "OpSpecID"};
  std::uint16_t op_spec_id = 0;
  static void fields(auto& v, auto& s) { v.value("OpSpecID", s.op_spec_id); }
};

struct ReaderExceptionEvent {
  static constexpr Name kName{252, "ReaderExceptionEvent"};
  std::string message;
  std::optional<ROSpecID> ro_spec_id;
  std::optional<SpecIndex> spec_index;
  std::optional<InventoryParameterSpecID> inventory_parameter_spec_id;
  std::optional<AntennaID> antenna_id;
  std::optional<AccessSpecID> access_spec_id;
  std::optional<OpSpecID> op_spec_id;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.value("Message", s.message);
    v.child(s.ro_spec_id);
    v.child(s.spec_index);
    v.child(s.inventory_parameter_spec_id);
    v.child(s.antenna_id);
    v.child(s.access_spec_id);
    v.child(s.op_spec_id);
    v.child(s.customs);
  }
};

struct RFSurveyEvent {
  static constexpr Name kName{253, "RFSurveyEvent"};
  std::uint8_t event_type = 0;
  std::uint32_t ro_spec_id = 0;
  std::uint16_t spec_index = 0;
  static void fields(auto& v, auto& s) {
    v.value("EventType", s.event_type);
    v.value("ROSpecID", s.ro_spec_id);
    v.value("SpecIndex", s.spec_index);
  }
};

struct C1G2SingulationDetails {
  static constexpr Name kName{18, "C1G2SingulationDetails"};
  std::uint16_t num_collision_slots = 0;
  std::uint16_t num_empty_slots = 0;
  static void fields(auto& v, auto& s) {
    v.value("NumCollisionSlots", s.num_collision_slots);
    v.value("NumEmptySlots", s.num_empty_slots);
  }
};

struct AISpecEvent {
  static constexpr Name kName{254, "AISpecEvent"};
  std::uint8_t event_type = 0;
  std::uint32_t ro_spec_id = 0;
  std::uint16_t spec_index = 0;
  std::optional<C1G2SingulationDetails> c1g2_singulation_details;
  static void fields(auto& v, auto& s) {
    v.value("EventType", s.event_type);
    v.value("ROSpecID", s.ro_spec_id);
    v.value("SpecIndex", s.spec_index);
    v.child(s.c1g2_singulation_details);
  }
};

struct AntennaEvent {
  static constexpr Name kName{255, "AntennaEvent"};
  std::uint8_t event_type = 0;
  std::uint16_t antenna_id = 0;
  static void fields(auto& v, auto& s) {
    v.value("EventType", s.event_type);
    v.value("AntennaID", s.antenna_id);
  }
};

struct ConnectionAttemptEvent {
  static constexpr Name kName{256, "ConnectionAttemptEvent"};
  std::uint16_t status = 0;
  static void fields(auto& v, auto& s) { v.value("Status", s.status); }
};

struct ConnectionCloseEvent {
  static constexpr Name kName{257, "ConnectionCloseEvent"};
  static void fields(auto&, auto&) {}
};

struct ReaderEventNotificationData {
  static constexpr Name kName{246, "ReaderEventNotificationData"};
  Timestamp timestamp;
  std::optional<HoppingEvent> hopping_event;
  std::optional<GPIEvent> gpi_event;
  std::optional<ROSpecEvent> ro_spec_event;
  std::optional<ReportBufferLevelWarningEvent> report_buffer_level_warning_event;
  std::optional<ReportBufferOverflowErrorEvent> report_buffer_overflow_error_event;
  std::optional<ReaderExceptionEvent> reader_exception_event;
  std::optional<RFSurveyEvent> rf_survey_event;
  std::optional<AISpecEvent> ai_spec_event;
  std::optional<AntennaEvent> antenna_event;
  std::optional<ConnectionAttemptEvent> connection_attempt_event;
  std::optional<ConnectionCloseEvent> connection_close_event;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.child(s.timestamp);
    v.child(s.hopping_event);
    v.child(s.gpi_event);
    v.child(s.ro_spec_event);
    v.child(s.report_buffer_level_warning_event);
    v.child(s.report_buffer_overflow_error_event);
    v.child(s.reader_exception_event);
    v.child(s.rf_survey_event);
    v.child(s.ai_spec_event);
    v.child(s.antenna_event);
    v.child(s.connection_attempt_event);
    v.child(s.connection_close_event);
    v.child(s.customs);
  }
};

}  // namespace rfmvo::llrp
