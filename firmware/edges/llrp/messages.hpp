// The messages of LLRP 1.0.1 that a client of inventories and a simulated reader exchange. What only tag access
// needs (ADD_ACCESSSPEC and its kin) stays a RawMessage, as GET_SUPPORTED_VERSION of LLRP 1.1 does.
#pragma once

#include "edges/llrp/capabilities.hpp"
#include "edges/llrp/config.hpp"
#include "edges/llrp/events.hpp"
#include "edges/llrp/report.hpp"
#include "edges/llrp/rospec.hpp"
#include "edges/llrp/status.hpp"

namespace rfmvo::llrp {

struct NoFields {
  static void fields(auto&, auto&) {}
};
struct StatusOnly {
  LLRPStatus llrp_status;
  static void fields(auto& v, auto& s) { v.child(s.llrp_status); }
};
struct OneRoSpec {
  std::uint32_t ro_spec_id = 0;  // 0: all
  static void fields(auto& v, auto& s) { v.value("ROSpecID", s.ro_spec_id); }
};

// clang-format off
struct GetRoSpecs : NoFields { static constexpr Name kName{26, "GET_ROSPECS"}; };
struct CloseConnection : NoFields { static constexpr Name kName{14, "CLOSE_CONNECTION"}; };
struct GetReport : NoFields { static constexpr Name kName{60, "GET_REPORT"}; };
struct Keepalive : NoFields { static constexpr Name kName{62, "KEEPALIVE"}; };
struct KeepaliveAck : NoFields { static constexpr Name kName{72, "KEEPALIVE_ACK"}; };
struct EnableEventsAndReports : NoFields { static constexpr Name kName{64, "ENABLE_EVENTS_AND_REPORTS"}; };

struct DeleteRoSpec : OneRoSpec { static constexpr Name kName{21, "DELETE_ROSPEC"}; };
struct StartRoSpec : OneRoSpec { static constexpr Name kName{22, "START_ROSPEC"}; };
struct StopRoSpec : OneRoSpec { static constexpr Name kName{23, "STOP_ROSPEC"}; };
struct EnableRoSpec : OneRoSpec { static constexpr Name kName{24, "ENABLE_ROSPEC"}; };
struct DisableRoSpec : OneRoSpec { static constexpr Name kName{25, "DISABLE_ROSPEC"}; };

struct CloseConnectionResponse : StatusOnly { static constexpr Name kName{4, "CLOSE_CONNECTION_RESPONSE"}; };
struct SetReaderConfigResponse : StatusOnly { static constexpr Name kName{13, "SET_READER_CONFIG_RESPONSE"}; };
struct AddRoSpecResponse : StatusOnly { static constexpr Name kName{30, "ADD_ROSPEC_RESPONSE"}; };
struct DeleteRoSpecResponse : StatusOnly { static constexpr Name kName{31, "DELETE_ROSPEC_RESPONSE"}; };
struct StartRoSpecResponse : StatusOnly { static constexpr Name kName{32, "START_ROSPEC_RESPONSE"}; };
struct StopRoSpecResponse : StatusOnly { static constexpr Name kName{33, "STOP_ROSPEC_RESPONSE"}; };
struct EnableRoSpecResponse : StatusOnly { static constexpr Name kName{34, "ENABLE_ROSPEC_RESPONSE"}; };
struct DisableRoSpecResponse : StatusOnly { static constexpr Name kName{35, "DISABLE_ROSPEC_RESPONSE"}; };
struct DeleteAccessSpecResponse : StatusOnly { static constexpr Name kName{51, "DELETE_ACCESSSPEC_RESPONSE"}; };
struct ErrorMessage : StatusOnly { static constexpr Name kName{100, "ERROR_MESSAGE"}; };
// clang-format on

struct CustomMessage {
  static constexpr Name kName{1023, "CUSTOM_MESSAGE"};
  std::uint32_t vendor_identifier = 0;
  std::uint8_t message_subtype = 0;
  std::vector<std::uint8_t> data;
  static void fields(auto& v, auto& s) {
    v.value("VendorIdentifier", s.vendor_identifier);
    v.value("MessageSubtype", s.message_subtype);
    v.rest("Data", s.data);
  }
};

struct GetReaderCapabilities {
  static constexpr Name kName{1, "GET_READER_CAPABILITIES"};
  std::uint8_t requested_data = 0;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.value("RequestedData", s.requested_data);
    v.child(s.customs);
  }
};

struct GetReaderCapabilitiesResponse {
  static constexpr Name kName{11, "GET_READER_CAPABILITIES_RESPONSE"};
  LLRPStatus llrp_status;
  std::optional<GeneralDeviceCapabilities> general_device_capabilities;
  std::optional<LLRPCapabilities> llrp_capabilities;
  std::optional<RegulatoryCapabilities> regulatory_capabilities;
  std::optional<C1G2LLRPCapabilities> c1g2_llrp_capabilities;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.child(s.llrp_status);
    v.child(s.general_device_capabilities);
    v.child(s.llrp_capabilities);
    v.child(s.regulatory_capabilities);
    v.child(s.c1g2_llrp_capabilities);
    v.child(s.customs);
  }
};

struct AddRoSpec {
  static constexpr Name kName{20, "ADD_ROSPEC"};
  ROSpec ro_spec;
  static void fields(auto& v, auto& s) { v.child(s.ro_spec); }
};

struct GetRoSpecsResponse {
  static constexpr Name kName{36, "GET_ROSPECS_RESPONSE"};
  LLRPStatus llrp_status;
  std::vector<ROSpec> ro_specs;
  static void fields(auto& v, auto& s) {
    v.child(s.llrp_status);
    v.child(s.ro_specs);
  }
};

struct DeleteAccessSpec {
  static constexpr Name kName{41, "DELETE_ACCESSSPEC"};
  std::uint32_t access_spec_id = 0;
  static void fields(auto& v, auto& s) { v.value("AccessSpecID", s.access_spec_id); }
};

struct GetReaderConfig {
  static constexpr Name kName{2, "GET_READER_CONFIG"};
  std::uint16_t antenna_id = 0;
  std::uint8_t requested_data = 0;
  std::uint16_t gpi_port_num = 0;
  std::uint16_t gpo_port_num = 0;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.value("AntennaID", s.antenna_id);
    v.value("RequestedData", s.requested_data);
    v.value("GPIPortNum", s.gpi_port_num);
    v.value("GPOPortNum", s.gpo_port_num);
    v.child(s.customs);
  }
};

struct GetReaderConfigResponse {
  static constexpr Name kName{12, "GET_READER_CONFIG_RESPONSE"};
  LLRPStatus llrp_status;
  std::optional<Identification> identification;
  std::vector<AntennaProperties> antenna_properties;
  std::vector<AntennaConfiguration> antenna_configurations;
  std::optional<ReaderEventNotificationSpec> reader_event_notification_spec;
  std::optional<ROReportSpec> ro_report_spec;
  std::optional<AccessReportSpec> access_report_spec;
  std::optional<LLRPConfigurationStateValue> llrp_configuration_state_value;
  std::optional<KeepaliveSpec> keepalive_spec;
  std::vector<GPIPortCurrentState> gpi_port_current_states;
  std::vector<GPOWriteData> gpo_write_data;
  std::optional<EventsAndReports> events_and_reports;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.child(s.llrp_status);
    v.child(s.identification);
    v.child(s.antenna_properties);
    v.child(s.antenna_configurations);
    v.child(s.reader_event_notification_spec);
    v.child(s.ro_report_spec);
    v.child(s.access_report_spec);
    v.child(s.llrp_configuration_state_value);
    v.child(s.keepalive_spec);
    v.child(s.gpi_port_current_states);
    v.child(s.gpo_write_data);
    v.child(s.events_and_reports);
    v.child(s.customs);
  }
};

struct SetReaderConfig {
  static constexpr Name kName{3, "SET_READER_CONFIG"};
  bool reset_to_factory_default = false;
  std::optional<ReaderEventNotificationSpec> reader_event_notification_spec;
  std::vector<AntennaProperties> antenna_properties;
  std::vector<AntennaConfiguration> antenna_configurations;
  std::optional<ROReportSpec> ro_report_spec;
  std::optional<AccessReportSpec> access_report_spec;
  std::optional<KeepaliveSpec> keepalive_spec;
  std::vector<GPOWriteData> gpo_write_data;
  std::vector<GPIPortCurrentState> gpi_port_current_states;
  std::optional<EventsAndReports> events_and_reports;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.bits("ResetToFactoryDefault", s.reset_to_factory_default, 1);
    v.reserved(7);
    v.child(s.reader_event_notification_spec);
    v.child(s.antenna_properties);
    v.child(s.antenna_configurations);
    v.child(s.ro_report_spec);
    v.child(s.access_report_spec);
    v.child(s.keepalive_spec);
    v.child(s.gpo_write_data);
    v.child(s.gpi_port_current_states);
    v.child(s.events_and_reports);
    v.child(s.customs);
  }
};

struct RoAccessReport {
  static constexpr Name kName{61, "RO_ACCESS_REPORT"};
  std::vector<TagReportData> tag_report_data;
  std::vector<RFSurveyReportData> rf_survey_report_data;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.child(s.tag_report_data);
    v.child(s.rf_survey_report_data);
    v.child(s.customs);
  }
};

struct ReaderEventNotification {
  static constexpr Name kName{63, "READER_EVENT_NOTIFICATION"};
  ReaderEventNotificationData reader_event_notification_data;
  static void fields(auto& v, auto& s) { v.child(s.reader_event_notification_data); }
};

// A message whose body is not looked into.
struct RawMessage {
  std::uint16_t type = 0;
  std::vector<std::uint8_t> body;
};

using Body = std::variant<RawMessage, GetReaderCapabilities, GetReaderCapabilitiesResponse, GetReaderConfig,
                          GetReaderConfigResponse, SetReaderConfig, SetReaderConfigResponse, CloseConnection,
                          CloseConnectionResponse, AddRoSpec, AddRoSpecResponse, DeleteRoSpec, DeleteRoSpecResponse,
                          StartRoSpec, StartRoSpecResponse, StopRoSpec, StopRoSpecResponse, EnableRoSpec,
                          EnableRoSpecResponse, DisableRoSpec, DisableRoSpecResponse, GetRoSpecs, GetRoSpecsResponse,
                          DeleteAccessSpec, DeleteAccessSpecResponse, GetReport, RoAccessReport, Keepalive,
                          KeepaliveAck, ReaderEventNotification, EnableEventsAndReports, ErrorMessage, CustomMessage>;

struct Message {
  std::uint32_t id = 0;
  Body body;
};

}  // namespace rfmvo::llrp
