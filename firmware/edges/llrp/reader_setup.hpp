// What is said to a reader before it reads: one list of requests, each with what becomes of a refusal. Pure.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "edges/llrp/codec.hpp"
#include "edges/llrp/reader_settings.hpp"

namespace rfmvo::llrp {

enum class Refusal : std::int8_t {
  kFatal,      // the connection is of no use
  kReported,   // goes on, with a fault
  kTolerated,  // expected of some readers: STOP of what does not run, DELETE of what is not there
};

struct Request {
  Body body;
  std::uint16_t response_type = 0;
  Refusal refusal = Refusal::kFatal;
};

// Everything that depends on what the reader says of itself.
struct ReaderPlan {
  std::uint32_t vendor = 0;
  std::string description;  // "vendor 25882, model 2001002, firmware 5.14.0.240, 50 channels"
  ChannelTable channels;
  ROSpec ro_spec;
  std::vector<Request> requests;  // after the capabilities, in order; the last one starts the reading
};

inline constexpr std::uint32_t kRoSpecId = 1;

[[nodiscard]] Request capabilities_request();
// Errors name what the reader cannot do: antenna, mode, power, channel table.
[[nodiscard]] Result<ReaderPlan> plan_reader(const GetReaderCapabilitiesResponse& capabilities,
                                             const ReaderSettings& settings);
// To leave the reader as one would wish to find it.
[[nodiscard]] std::vector<Request> goodbye_requests();

// The first thing in which what the reader holds differs from what it was told; empty: nothing.
[[nodiscard]] std::string difference(const ROSpec& told, const GetRoSpecsResponse& held);
[[nodiscard]] std::string difference(const ReaderSettings& told, const GetReaderConfigResponse& held);

}  // namespace rfmvo::llrp
