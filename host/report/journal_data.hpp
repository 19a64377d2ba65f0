// What a journal adds to the page about its result: every read, and every fault.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "estimator/estimate.hpp"
#include "evaluate/last_estimates.hpp"

namespace rfmvo::report {

struct ReadPoint {
  DeviceTime time;
  Epc epc;
  std::uint8_t port = 1;
  // Phase less what path, tag position and the offsets of tag, port and cable explain; nothing where there is no path
  // or the tag is not located.
  std::optional<double> residual_rad;
};

struct JournalData {
  std::vector<ReadPoint> reads;
  std::vector<Fault> faults;
};

// The residuals are of the last estimates: those of a tag with the wrong position stray, those of one that is right
// show multipath. Errors: as of the journal reader.
[[nodiscard]] Result<JournalData> read_journal_data(const std::string& path, const std::string& prefix,
                                                    const evaluate::LastEstimates& last);

// Fills residual_rad. `reads` are those that the points are of, one by one. The offsets are the residuals' own circular
// means of each tag and port, after a slope over frequency that all tags of a port share (the cable's length).
void add_residuals(const std::vector<TagRead>& reads, const Calibration& calibration,
                   const evaluate::LastEstimates& last, std::vector<ReadPoint>& points);

}  // namespace rfmvo::report
