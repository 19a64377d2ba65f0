#include "edges/lcm_codec_parts.hpp"

namespace rfmvo::codec {

camera_pose_t message_of(const CameraPose& pose) {
  camera_pose_t m{};
  m.utime = pose.time.us();
  m.segment = pose.segment;
  m.status = static_cast<std::int8_t>(pose.status);
  m.inliers = pose.inliers;
  put(m.pos, pose.T_V_C.p_V_C);
  put(m.orientation, pose.T_V_C.R_V_C);
  put(m.motion_covariance, pose.motion_covariance);
  return m;
}

Result<CameraPose> camera_pose_of(const camera_pose_t& m, std::string_view channel) {
  if (m.status < camera_pose_t::INITIALISING || m.status > camera_pose_t::LOST)
    return malformed("unknown status " + std::to_string(m.status), channel);
  if (!fits<std::uint32_t>(m.segment)) return malformed("segment is out of range", channel);
  if (m.inliers < 0) return malformed("inliers is negative", channel);
  if (!finite(m.pos) || !finite(m.motion_covariance)) return malformed("a number is not finite", channel);
  if (!is_unit(m.orientation)) return malformed("orientation is not a unit quaternion", channel);
  CameraPose pose;
  pose.time = DeviceTime::from_us(m.utime);
  pose.segment = static_cast<std::uint32_t>(m.segment);
  pose.status = static_cast<VoStatus>(m.status);
  pose.inliers = m.inliers;
  pose.T_V_C = {quaternion_of(m.orientation), vector_of(m.pos)};
  pose.motion_covariance = matrix_of(m.motion_covariance);
  return pose;
}

reader_status_t message_of(const ReaderStatus& status) {
  reader_status_t m;
  m.utime = status.time.us();
  m.reading = status.reading ? 1 : 0;
  m.clock_known = status.clock_known ? 1 : 0;
  m.clock_offset_s = status.clock_offset_s;
  m.clock_drift = status.clock_drift;
  m.clock_sigma_s = status.clock_sigma_s;
  m.clock_steps = status.clock_steps;
  m.connections = status.connections;
  m.reports_lost = static_cast<std::int64_t>(status.reports_lost);
  return m;
}

Result<ReaderStatus> reader_status_of(const reader_status_t& m, std::string_view channel) {
  if (m.utime > kMaxUtime || m.utime < -kMaxUtime) return malformed("reader status: utime is out of range", channel);
  if (!std::isfinite(m.clock_offset_s) || !std::isfinite(m.clock_drift) || !std::isfinite(m.clock_sigma_s))
    return malformed("reader status: a number is not finite", channel);
  if (!fits<std::uint32_t>(m.clock_steps) || !fits<std::uint32_t>(m.connections) || m.reports_lost < 0)
    return malformed("reader status: a count is out of range", channel);
  ReaderStatus status;
  status.time = DeviceTime::from_us(m.utime);
  status.reading = m.reading != 0;
  status.clock_known = m.clock_known != 0;
  status.clock_offset_s = m.clock_offset_s;
  status.clock_drift = m.clock_drift;
  status.clock_sigma_s = m.clock_sigma_s;
  status.clock_steps = static_cast<std::uint32_t>(m.clock_steps);
  status.connections = static_cast<std::uint32_t>(m.connections);
  status.reports_lost = static_cast<std::uint64_t>(m.reports_lost);
  return status;
}

}  // namespace rfmvo::codec
