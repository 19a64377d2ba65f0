// Reports of tags. Types below 128 are TV-encoded. LLRP 1.0.1 sections 13.2.3, 15.2.2.
// Names are the standard's; one `fields` per parameter serves decoding and encoding (schema.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "edges/llrp/rospec.hpp"

namespace rfmvo::llrp {

struct EPCData {
  static constexpr Name kName{241, "EPCData"};
  BitString epc;
  static void fields(auto& v, auto& s) { v.value("EPC", s.epc); }
};

struct EPC_96 {
  static constexpr Name kName{13, "EPC_96"};
  std::array<std::uint8_t, 12> epc{};
  static void fields(auto& v, auto& s) { v.value("EPC", s.epc); }
};

struct ROSpecID {
  static constexpr Name kName{9, "ROSpecID"};
  std::uint32_t ro_spec_id = 0;
  static void fields(auto& v, auto& s) { v.value("ROSpecID", s.ro_spec_id); }
};

struct SpecIndex {
  static constexpr Name kName{14, "SpecIndex"};
  std::uint16_t spec_index = 0;
  static void fields(auto& v, auto& s) { v.value("SpecIndex", s.spec_index); }
};

struct InventoryParameterSpecID {
  static constexpr Name kName{10, "InventoryParameterSpecID"};
  std::uint16_t inventory_parameter_spec_id = 0;
  static void fields(auto& v, auto& s) { v.value("InventoryParameterSpecID", s.inventory_parameter_spec_id); }
};

struct AntennaID {
  static constexpr Name kName{1, "AntennaID"};
  std::uint16_t antenna_id = 0;
  static void fields(auto& v, auto& s) { v.value("AntennaID", s.antenna_id); }
};

struct PeakRSSI {
  static constexpr Name kName{6, "PeakRSSI"};
  std::int8_t peak_rssi = 0;
  static void fields(auto& v, auto& s) { v.value("PeakRSSI", s.peak_rssi); }
};

struct ChannelIndex {
  static constexpr Name kName{7, "ChannelIndex"};
  std::uint16_t channel_index = 0;
  static void fields(auto& v, auto& s) { v.value("ChannelIndex", s.channel_index); }
};

struct FirstSeenTimestampUTC {
  static constexpr Name kName{2, "FirstSeenTimestampUTC"};
  std::uint64_t microseconds = 0;
  static void fields(auto& v, auto& s) { v.value("Microseconds", s.microseconds); }
};

struct FirstSeenTimestampUptime {
  static constexpr Name kName{3, "FirstSeenTimestampUptime"};
  std::uint64_t microseconds = 0;
  static void fields(auto& v, auto& s) { v.value("Microseconds", s.microseconds); }
};

struct LastSeenTimestampUTC {
  static constexpr Name kName{4, "LastSeenTimestampUTC"};
  std::uint64_t microseconds = 0;
  static void fields(auto& v, auto& s) { v.value("Microseconds", s.microseconds); }
};

struct LastSeenTimestampUptime {
  static constexpr Name kName{5, "LastSeenTimestampUptime"};
  std::uint64_t microseconds = 0;
  static void fields(auto& v, auto& s) { v.value("Microseconds", s.microseconds); }
};

struct TagSeenCount {
  static constexpr Name kName{8, "TagSeenCount"};
  std::uint16_t tag_count = 0;
  static void fields(auto& v, auto& s) { v.value("TagCount", s.tag_count); }
};

struct C1G2_PC {
  static constexpr Name kName{12, "C1G2_PC"};
  std::uint16_t pc_bits = 0;
  static void fields(auto& v, auto& s) { v.value("PC_Bits", s.pc_bits); }
};

struct C1G2_CRC {
  static constexpr Name kName{11, "C1G2_CRC"};
  std::uint16_t crc = 0;
  static void fields(auto& v, auto& s) { v.value("CRC", s.crc); }
};

struct AccessSpecID {
  static constexpr Name kName{16, "AccessSpecID"};
  std::uint32_t access_spec_id = 0;
  static void fields(auto& v, auto& s) { v.value("AccessSpecID", s.access_spec_id); }
};

struct C1G2ReadOpSpecResult {
  static constexpr Name kName{349, "C1G2ReadOpSpecResult"};
  std::uint8_t result = 0;
  std::uint16_t op_spec_id = 0;
  std::vector<std::uint16_t> read_data;
  static void fields(auto& v, auto& s) {
    v.value("Result", s.result);
    v.value("OpSpecID", s.op_spec_id);
    v.value("ReadData", s.read_data);
  }
};

struct C1G2WriteOpSpecResult {
  static constexpr Name kName{350, "C1G2WriteOpSpecResult"};
  std::uint8_t result = 0;
  std::uint16_t op_spec_id = 0;
  std::uint16_t num_words_written = 0;
  static void fields(auto& v, auto& s) {
    v.value("Result", s.result);
    v.value("OpSpecID", s.op_spec_id);
    v.value("NumWordsWritten", s.num_words_written);
  }
};

struct C1G2KillOpSpecResult {
  static constexpr Name kName{351, "C1G2KillOpSpecResult"};
  std::uint8_t result = 0;
  std::uint16_t op_spec_id = 0;
  static void fields(auto& v, auto& s) {
    v.value("Result", s.result);
    v.value("OpSpecID", s.op_spec_id);
  }
};

struct C1G2LockOpSpecResult {
  static constexpr Name kName{352, "C1G2LockOpSpecResult"};
  std::uint8_t result = 0;
  std::uint16_t op_spec_id = 0;
  static void fields(auto& v, auto& s) {
    v.value("Result", s.result);
    v.value("OpSpecID", s.op_spec_id);
  }
};

struct C1G2BlockEraseOpSpecResult {
  static constexpr Name kName{353, "C1G2BlockEraseOpSpecResult"};
  std::uint8_t result = 0;
  std::uint16_t op_spec_id = 0;
  static void fields(auto& v, auto& s) {
    v.value("Result", s.result);
    v.value("OpSpecID", s.op_spec_id);
  }
};

struct C1G2BlockWriteOpSpecResult {
  static constexpr Name kName{354, "C1G2BlockWriteOpSpecResult"};
  std::uint8_t result = 0;
  std::uint16_t op_spec_id = 0;
  std::uint16_t num_words_written = 0;
  static void fields(auto& v, auto& s) {
    v.value("Result", s.result);
    v.value("OpSpecID", s.op_spec_id);
    v.value("NumWordsWritten", s.num_words_written);
  }
};

using EPCParameter = std::variant<std::monostate, EPCData, EPC_96>;
using AirProtocolTagData = std::variant<C1G2_PC, C1G2_CRC>;
using AccessCommandOpSpecResult =
    std::variant<C1G2ReadOpSpecResult, C1G2WriteOpSpecResult, C1G2KillOpSpecResult, C1G2LockOpSpecResult,
                 C1G2BlockEraseOpSpecResult, C1G2BlockWriteOpSpecResult>;

struct TagReportData {
  static constexpr Name kName{240, "TagReportData"};
  EPCParameter epc_parameter;
  std::optional<ROSpecID> ro_spec_id;
  std::optional<SpecIndex> spec_index;
  std::optional<InventoryParameterSpecID> inventory_parameter_spec_id;
  std::optional<AntennaID> antenna_id;
  std::optional<PeakRSSI> peak_rssi;
  std::optional<ChannelIndex> channel_index;
  std::optional<FirstSeenTimestampUTC> first_seen_timestamp_utc;
  std::optional<FirstSeenTimestampUptime> first_seen_timestamp_uptime;
  std::optional<LastSeenTimestampUTC> last_seen_timestamp_utc;
  std::optional<LastSeenTimestampUptime> last_seen_timestamp_uptime;
  std::optional<TagSeenCount> tag_seen_count;
  std::vector<AirProtocolTagData> air_protocol_tag_data;
  std::optional<AccessSpecID> access_spec_id;
  std::vector<AccessCommandOpSpecResult> access_command_op_spec_results;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.child(s.epc_parameter);
    v.child(s.ro_spec_id);
    v.child(s.spec_index);
    v.child(s.inventory_parameter_spec_id);
    v.child(s.antenna_id);
    v.child(s.peak_rssi);
    v.child(s.channel_index);
    v.child(s.first_seen_timestamp_utc);
    v.child(s.first_seen_timestamp_uptime);
    v.child(s.last_seen_timestamp_utc);
    v.child(s.last_seen_timestamp_uptime);
    v.child(s.tag_seen_count);
    v.child(s.air_protocol_tag_data);
    v.child(s.access_spec_id);
    v.child(s.access_command_op_spec_results);
    v.child(s.customs);
  }
};

struct FrequencyRSSILevelEntry {
  static constexpr Name kName{243, "FrequencyRSSILevelEntry"};
  std::uint32_t frequency = 0;
  std::uint32_t bandwidth = 0;
  std::int8_t average_rssi = 0;
  std::int8_t peak_rssi = 0;
  Timestamp timestamp;
  static void fields(auto& v, auto& s) {
    v.value("Frequency", s.frequency);
    v.value("Bandwidth", s.bandwidth);
    v.value("AverageRSSI", s.average_rssi);
    v.value("PeakRSSI", s.peak_rssi);
    v.child(s.timestamp);
  }
};

struct RFSurveyReportData {
  static constexpr Name kName{242, "RFSurveyReportData"};
  std::optional<ROSpecID> ro_spec_id;
  std::optional<SpecIndex> spec_index;
  std::vector<FrequencyRSSILevelEntry> frequency_rssi_level_entries;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.child(s.ro_spec_id);
    v.child(s.spec_index);
    v.child(s.frequency_rssi_level_entries);
    v.child(s.customs);
  }
};

}  // namespace rfmvo::llrp
