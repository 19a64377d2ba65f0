#include "edges/llrp/channel_table.hpp"

#include <algorithm>
#include <string>

namespace rfmvo::llrp {
namespace {

constexpr std::uint32_t kLowest_khz = 840'000, kHighest_khz = 960'000;  // all UHF RFID bands, ISO 18000-63: 860..960
constexpr const char* kWhere = "GET_READER_CAPABILITIES_RESPONSE.FrequencyInformation";

Result<ChannelTable> checked(ChannelTable table, const std::vector<std::uint32_t>& channels_khz) {
  if (channels_khz.empty()) return Error{ErrorCode::kMalformed, "the reader's table of channels is empty", kWhere};
  for (const std::uint32_t khz : channels_khz) {
    if (khz < kLowest_khz || khz > kHighest_khz)
      return Error{ErrorCode::kOutOfRange, "a channel of " + std::to_string(khz) + " kHz is outside 840 to 960 MHz",
                   kWhere};
    table.channels_hz.push_back(khz * 1000);
  }
  return table;
}

}  // namespace

Result<ChannelTable> channel_table(const GetReaderCapabilitiesResponse& capabilities, std::uint8_t hop_table_id) {
  const auto& regulatory = capabilities.regulatory_capabilities;
  if (!regulatory || !regulatory->uhf_band_capabilities)
    return Error{ErrorCode::kMalformed, "the reader states no UHF band", kWhere};
  const FrequencyInformation& info = regulatory->uhf_band_capabilities->frequency_information;
  if (!info.hopping) {
    if (!info.fixed_frequency_table) return Error{ErrorCode::kMalformed, "the reader states no frequencies", kWhere};
    return checked({}, info.fixed_frequency_table->frequency);
  }
  std::string known;
  for (const FrequencyHopTable& table : info.frequency_hop_tables) {
    if (hop_table_id == 0 || table.hop_table_id == hop_table_id)
      return checked({true, table.hop_table_id, {}}, table.frequency);
    known += " " + std::to_string(table.hop_table_id);
  }
  return Error{ErrorCode::kMalformed,
               known.empty() ? "the reader hops, but states no hop table"
                             : "the reader has no hop table " + std::to_string(hop_table_id) + "; it has" + known,
               kWhere};
}

}  // namespace rfmvo::llrp
