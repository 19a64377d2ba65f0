// Configuration of the reader: keepalives, which events are told, antennas, ports. LLRP 1.0.1 section 12.
// Names are the standard's; one `fields` per parameter serves decoding and encoding (schema.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "edges/llrp/rospec.hpp"

namespace rfmvo::llrp {

struct LLRPConfigurationStateValue {
  static constexpr Name kName{217, "LLRPConfigurationStateValue"};
  std::uint32_t llrp_configuration_state_value = 0;
  static void fields(auto& v, auto& s) { v.value("LLRPConfigurationStateValue", s.llrp_configuration_state_value); }
};

struct Identification {
  static constexpr Name kName{218, "Identification"};
  std::uint8_t id_type = 0;
  std::vector<std::uint8_t> reader_id;
  static void fields(auto& v, auto& s) {
    v.value("IDType", s.id_type);
    v.value("ReaderID", s.reader_id);
  }
};

struct GPOWriteData {
  static constexpr Name kName{219, "GPOWriteData"};
  std::uint16_t gpo_port_number = 0;
  bool gpo_data = false;
  static void fields(auto& v, auto& s) {
    v.value("GPOPortNumber", s.gpo_port_number);
    v.bits("GPOData", s.gpo_data, 1);
    v.reserved(7);
  }
};

struct KeepaliveSpec {
  static constexpr Name kName{220, "KeepaliveSpec"};
  std::uint8_t keepalive_trigger_type = 0;
  std::uint32_t periodic_trigger_value = 0;
  static void fields(auto& v, auto& s) {
    v.value("KeepaliveTriggerType", s.keepalive_trigger_type);
    v.value("PeriodicTriggerValue", s.periodic_trigger_value);
  }
};

struct AntennaProperties {
  static constexpr Name kName{221, "AntennaProperties"};
  bool antenna_connected = false;
  std::uint16_t antenna_id = 0;
  std::int16_t antenna_gain = 0;
  static void fields(auto& v, auto& s) {
    v.bits("AntennaConnected", s.antenna_connected, 1);
    v.reserved(7);
    v.value("AntennaID", s.antenna_id);
    v.value("AntennaGain", s.antenna_gain);
  }
};

struct GPIPortCurrentState {
  static constexpr Name kName{225, "GPIPortCurrentState"};
  std::uint16_t gpi_port_num = 0;
  bool config = false;
  std::uint8_t state = 0;
  static void fields(auto& v, auto& s) {
    v.value("GPIPortNum", s.gpi_port_num);
    v.bits("Config", s.config, 1);
    v.reserved(7);
    v.value("State", s.state);
  }
};

struct EventsAndReports {
  static constexpr Name kName{226, "EventsAndReports"};
  bool hold_events_and_reports_upon_reconnect = false;
  static void fields(auto& v, auto& s) {
    v.bits("HoldEventsAndReportsUponReconnect", s.hold_events_and_reports_upon_reconnect, 1);
    v.reserved(7);
  }
};

struct AccessReportSpec {
  static constexpr Name kName{239, "AccessReportSpec"};
  std::uint8_t access_report_trigger = 0;
  static void fields(auto& v, auto& s) { v.value("AccessReportTrigger", s.access_report_trigger); }
};

struct EventNotificationState {
  static constexpr Name kName{245, "EventNotificationState"};
  std::uint16_t event_type = 0;
  bool notification_state = false;
  static void fields(auto& v, auto& s) {
    v.value("EventType", s.event_type);
    v.bits("NotificationState", s.notification_state, 1);
    v.reserved(7);
  }
};

struct ReaderEventNotificationSpec {
  static constexpr Name kName{244, "ReaderEventNotificationSpec"};
  std::vector<EventNotificationState> event_notification_states;
  static void fields(auto& v, auto& s) { v.child(s.event_notification_states); }
};

}  // namespace rfmvo::llrp
