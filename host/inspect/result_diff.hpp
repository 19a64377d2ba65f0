// Where two results differ: first record by record, then by what they say.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "evaluate/last_estimates.hpp"

namespace rfmvo::inspect {

struct Tolerance {
  double position_m = 0.0;  // of tags and of the path
  double scale = 0.0;       // relative
  // Without one, the same means: the same bytes.
  [[nodiscard]] bool none() const { return position_m <= 0.0 && scale <= 0.0; }
};

// The first record, counted from 0, that is not the same in both.
struct FirstDifference {
  std::uint64_t index = 0;
  std::string a, b;  // "RFMVO_TAG at 12.345678 s" or "the end"
};

struct SettingDifference {
  std::string key, a, b;
};

struct TagDifference {
  Epc epc;
  std::optional<TagEstimate> a, b;   // the last ones; nothing: not in this result
  std::optional<double> distance_m;  // if both are located
  [[nodiscard]] bool within(double tolerance_m) const;
};

struct ScaleDifference {
  std::uint32_t segment = 0;
  std::optional<ScaleEstimate> a, b;
  std::optional<double> relative;  // b / a - 1, if both are observable
  [[nodiscard]] bool within(double tolerance) const;
};

struct PathDifference {
  std::uint32_t segment = 0;
  std::size_t poses_a = 0, poses_b = 0, compared = 0;  // those with the same time
  double rms_m = 0.0, max_m = 0.0;
  DeviceTime max_at;
  [[nodiscard]] bool within(double tolerance_m) const;
};

struct ResultDiff {
  std::uint64_t records_a = 0, records_b = 0;
  std::optional<FirstDifference> first;  // nothing: the same bytes
  std::vector<SettingDifference> settings;
  std::vector<TagDifference> tags;      // all of both, by EPC
  std::vector<ScaleDifference> scales;  // all of both, by segment
  std::vector<PathDifference> paths;    // all of both, by segment

  [[nodiscard]] bool same(const Tolerance& tolerance) const;
};

// Errors: as of the log reader, naming the file.
[[nodiscard]] Result<ResultDiff> diff_results(const std::string& a, const std::string& b, const std::string& prefix);

// Only what differs by more than the tolerance; "the same" if nothing does.
[[nodiscard]] std::string to_text(const ResultDiff& diff, const Tolerance& tolerance);
[[nodiscard]] std::string to_json(const ResultDiff& diff, const Tolerance& tolerance);

}  // namespace rfmvo::inspect
