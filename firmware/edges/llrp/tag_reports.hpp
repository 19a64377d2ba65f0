// Reports of tags as tag reads: what the report leaves out is carried over as the standard says, the phase comes
// from the vendor's extension, the channel from the reader's own table.
#pragma once

#include <cstdint>
#include <optional>

#include "edges/llrp/channel_table.hpp"
#include "rf/tag_read.hpp"

namespace rfmvo::llrp {

// Whether the phase that the reader reports grows with the distance to the tag; not the same for all makes.
enum class PhaseSign : std::int8_t { kGrows = 1, kFalls = -1 };

inline constexpr std::uint64_t kMaxStamp_us = 9'000'000'000'000'000;  // year 2255; fits nanoseconds

// Which of a reader's two clocks a stamp is from.
enum class StampKind : std::int8_t { kUtc, kUptime };

struct ReportedRead {
  TagRead read;  // all but `time`, which is for the clock filter to say
  StampKind stamp = StampKind::kUtc;
};

struct TagReportCounts {
  std::uint64_t reads = 0;
  std::uint64_t without_epc = 0;      // no EPC, or one of more than 62 bytes
  std::uint64_t without_phase = 0;    // extension not reported
  std::uint64_t without_channel = 0;  // no channel, or an index outside the table
  std::uint64_t without_time = 0;
  std::uint64_t without_port = 0;  // no antenna, or one above 255
  [[nodiscard]] std::uint64_t lost() const {
    return without_epc + without_phase + without_channel + without_time + without_port;
  }
};

// One per connection: "If an optional parameter is enabled, and is absent in the report, the Client SHALL assume
// that the value is identical to the last parameter of the same type received" (LLRP 1.1 section 14.2.3).
// Phase is not carried over: no vendor promises that for extensions.
class TagReports {
 public:
  TagReports(ChannelTable channels, PhaseSign sign) : channels_(std::move(channels)), sign_(sign) {}

  // The read; nothing, and counted, if something a read cannot be without is missing.
  [[nodiscard]] std::optional<ReportedRead> on(const TagReportData& report);
  [[nodiscard]] const TagReportCounts& counts() const { return counts_; }

 private:
  ChannelTable channels_;
  PhaseSign sign_;
  TagReportData last_;  // what was last received of each type
  TagReportCounts counts_;
};

}  // namespace rfmvo::llrp
