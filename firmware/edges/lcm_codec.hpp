// Events and estimates as LCM messages (lcm_types/rfmvo) and back. Pure: bytes in, values out. Every
// length and enumeration is checked here, once.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "estimator/estimate.hpp"
#include "estimator/event.hpp"

namespace rfmvo {

struct LcmMessage {
  std::string channel;  // with the prefix
  std::int64_t utime = 0;
  std::vector<std::uint8_t> data;
};

// Channel names without the prefix: START FRAME CAMERA_POSE TAG_READ TICK FAULT COMMAND (journal),
// VO_POSE TAG SCALE METRIC_POSE POSE TRAJECTORY MAP_REVISION HEALTH (outputs; a MetricPose goes out
// on METRIC_POSE and, as a copy for others that is not read back, on POSE).
[[nodiscard]] LcmMessage encode(const Event& event, std::string_view prefix);
[[nodiscard]] std::vector<LcmMessage> encode(const Estimate& estimate, std::string_view prefix);

// Frames keep their compressed bytes; grey8 frames get `grey` at once, others by decode_image().
[[nodiscard]] Result<Event> decode_event(std::string_view channel, std::span<const std::uint8_t> data, std::string_view prefix);
[[nodiscard]] Result<Estimate> decode_estimate(std::string_view channel, std::span<const std::uint8_t> data, std::string_view prefix);
[[nodiscard]] bool is_event_channel(std::string_view channel, std::string_view prefix);
[[nodiscard]] bool is_estimate_channel(std::string_view channel, std::string_view prefix);

// Fills frame.grey from frame.encoded (jpeg, png) if it is null.
[[nodiscard]] Status decode_image(Frame& frame);

}  // namespace rfmvo
