#include "inspect/message_types.hpp"

#include "rfmvo/camera_pose_t.hpp"
#include "rfmvo/command_t.hpp"
#include "rfmvo/fault_t.hpp"
#include "rfmvo/frame_t.hpp"
#include "rfmvo/health_t.hpp"
#include "rfmvo/map_revision_t.hpp"
#include "rfmvo/metric_pose_t.hpp"
#include "rfmvo/pose_t.hpp"
#include "rfmvo/reader_status_t.hpp"
#include "rfmvo/scale_t.hpp"
#include "rfmvo/start_t.hpp"
#include "rfmvo/tag_estimate_t.hpp"
#include "rfmvo/tag_read_t.hpp"
#include "rfmvo/tick_t.hpp"
#include "rfmvo/trajectory_t.hpp"

namespace rfmvo::inspect {
namespace {

template <class... Messages>
std::string_view find_type(std::int64_t fingerprint) {
  std::string_view name;
  ((Messages::getHash() == fingerprint ? void(name = Messages::getTypeName()) : void()), ...);
  return name;
}

}  // namespace

std::int64_t big_endian_int64(std::span<const std::uint8_t> bytes, std::size_t offset) {
  if (bytes.size() < 8 || offset > bytes.size() - 8) return 0;
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes.subspan(offset, 8)) value = value << 8 | byte;
  return static_cast<std::int64_t>(value);
}

std::int64_t fingerprint_of(std::span<const std::uint8_t> message) { return big_endian_int64(message, 0); }

std::string_view type_name(std::int64_t fingerprint) {
  return find_type<camera_pose_t, command_t, fault_t, frame_t, health_t, map_revision_t, metric_pose_t, pose_t,
                   reader_status_t, scale_t, start_t, tag_estimate_t, tag_read_t, tick_t, trajectory_t>(fingerprint);
}

}  // namespace rfmvo::inspect
