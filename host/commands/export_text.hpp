// Results in the formats of others.
#pragma once

#include <string>

#include "evaluate/last_estimates.hpp"

namespace rfmvo {

// TUM format, one pose of T_W_C a line: t tx ty tz qx qy qz qw; seconds and metres. Segments follow each
// other; each has a world of its own if the odometry lost continuity between them.
[[nodiscard]] std::string to_tum(const evaluate::LastEstimates& last);

// Header line and one line per tag in order of EPC: epc, status, x y z (m), the covariance's upper
// triangle (m^2), hdop, reads, segment. A tag that is not located has empty numbers.
[[nodiscard]] std::string to_tags_csv(const evaluate::LastEstimates& last);

// A FeatureCollection as of GeoJSON (RFC 7946), but that coordinates are metres in W, not degrees: one point a tag,
// null where it is not located; properties: epc, uri, status, covariance, hypotheses, reads.
[[nodiscard]] std::string to_tags_json(const evaluate::LastEstimates& last);

}  // namespace rfmvo
