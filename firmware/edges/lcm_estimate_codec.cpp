#include "edges/lcm_codec.hpp"
#include "edges/lcm_codec_parts.hpp"
#include "rfmvo/health_t.hpp"
#include "rfmvo/map_revision_t.hpp"
#include "rfmvo/metric_pose_t.hpp"
#include "rfmvo/pose_t.hpp"
#include "rfmvo/scale_t.hpp"
#include "rfmvo/tag_estimate_t.hpp"
#include "rfmvo/trajectory_t.hpp"

namespace rfmvo {
namespace {

using namespace codec;
using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kHashBytes = 8;
constexpr std::size_t kHypothesisBytes = 8 * (3 + 9 + 1);
constexpr std::size_t kMetricPoseBytes = 8 * (3 + 3 + 4 + 36);

metric_pose_t message_of_metric(const MetricPose& pose) {
  metric_pose_t m{};
  m.utime = pose.time.us();
  m.segment = pose.segment;
  m.map_revision = pose.map_revision;
  put(m.pos, pose.T_W_C.t);
  put(m.orientation, pose.T_W_C.R);
  put(m.covariance, pose.covariance);
  return m;
}

std::vector<LcmMessage> encode_one(const CameraPose& pose, std::string_view prefix) {
  return {pack(codec::message_of(pose), prefix, "VO_POSE")};
}

std::vector<LcmMessage> encode_one(const TagEstimate& tag, std::string_view prefix) {
  tag_estimate_t m{};
  m.utime = tag.time.us();
  m.epc.assign(tag.epc.bytes().begin(), tag.epc.bytes().end());
  m.epc_size = static_cast<std::int32_t>(m.epc.size());
  m.status = static_cast<std::int8_t>(tag.status);
  m.segment = tag.segment;
  m.map_revision = tag.map_revision;
  put(m.pos, tag.p_W_X_m);
  put(m.covariance, tag.covariance_m2);
  put(m.covariance_with_log_scale, tag.covariance_with_log_scale_m);
  m.closest_utime = tag.closest_approach.us();
  put(m.pos_camera, tag.p_C_X_m);
  put(m.covariance_camera, tag.covariance_C_m2);
  m.hdop = tag.hdop;
  m.bearing_sweep = tag.bearing_sweep_rad;
  m.independent_reads = tag.independent_reads;
  m.reads = static_cast<std::int32_t>(tag.reads);
  for (const TagHypothesis& h : tag.hypotheses) {
    tag_hypothesis_t hypothesis{};
    put(hypothesis.pos, h.p_W_X_m);
    put(hypothesis.covariance, h.covariance_m2);
    hypothesis.weight = h.weight;
    m.hypotheses.push_back(hypothesis);
  }
  m.num_hypotheses = static_cast<std::int32_t>(m.hypotheses.size());
  return {pack(m, prefix, "TAG")};
}

std::vector<LcmMessage> encode_one(const ScaleEstimate& scale, std::string_view prefix) {
  scale_t m{};
  m.utime = scale.time.us();
  m.segment = scale.segment;
  m.observable = scale.observable ? 1 : 0;
  m.m_per_unit = scale.m_per_unit;
  m.log_sigma = scale.log_sigma;
  return {pack(m, prefix, "SCALE")};
}

std::vector<LcmMessage> encode_one(const MetricPose& pose, std::string_view prefix) {
  pose_t plain{};
  plain.utime = pose.time.us();
  put(plain.pos, pose.T_W_C.t);
  put(plain.orientation, pose.T_W_C.R);
  return {pack(message_of_metric(pose), prefix, "METRIC_POSE"), pack(plain, prefix, "POSE")};
}

std::vector<LcmMessage> encode_one(const Trajectory& trajectory, std::string_view prefix) {
  trajectory_t m{};
  m.utime = trajectory.time.us();
  m.segment = trajectory.segment;
  m.map_revision = trajectory.map_revision;
  for (const MetricPose& pose : trajectory.poses) m.poses.push_back(message_of_metric(pose));
  m.num_poses = static_cast<std::int32_t>(m.poses.size());
  return {pack(m, prefix, "TRAJECTORY")};
}

std::vector<LcmMessage> encode_one(const MapRevision& revision, std::string_view prefix) {
  map_revision_t m{};
  m.utime = revision.time.us();
  m.revision = revision.revision;
  m.reason = revision.reason;
  return {pack(m, prefix, "MAP_REVISION")};
}

std::vector<LcmMessage> encode_one(const Health& health, std::string_view prefix) {
  health_t m{};
  m.utime = health.time.us();
  m.vo_status = static_cast<std::int8_t>(health.vo_status);
  m.segment = health.segment;
  m.inliers = health.inliers;
  m.frames = static_cast<std::int64_t>(health.frames);
  m.poses = static_cast<std::int64_t>(health.poses);
  m.reads = static_cast<std::int64_t>(health.reads);
  m.reads_without_pose = static_cast<std::int64_t>(health.reads_without_pose);
  m.reads_rejected = static_cast<std::int64_t>(health.reads_rejected);
  m.tags = static_cast<std::int32_t>(health.tags);
  m.tags_located = static_cast<std::int32_t>(health.tags_located);
  m.faults = static_cast<std::int64_t>(health.faults);
  m.last_fault = health.last_fault;
  m.reader = message_of(health.reader);
  return {pack(m, prefix, "HEALTH")};
}

Result<Estimate> decode_vo_pose(std::string_view channel, Bytes data) {
  camera_pose_t m;
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  auto pose = camera_pose_of(m, channel);
  if (!pose) return pose.error();
  return Estimate(std::move(pose).value());
}

Result<TagHypothesis> hypothesis_of(const tag_hypothesis_t& m, std::string_view channel) {
  if (!finite(m.pos) || !finite(m.covariance) || !(m.weight >= 0.0 && m.weight <= 1.0 + 1e-9))
    return malformed("a hypothesis is not finite or its weight is not a probability", channel);
  return TagHypothesis{vector_of(m.pos), matrix_of(m.covariance), m.weight};
}

bool tag_arrays_fit(Bytes data) {
  constexpr std::size_t kEpcOffset = kHashBytes + 8;
  constexpr std::size_t kBetween = 1 + 8 * (2 + 3 + 9 + 3 + 1 + 3 + 9 + 3) + 4;  // from the EPC to num_hypotheses
  if (!holds_array(data, kEpcOffset, 1)) return false;
  const auto epc_bytes = static_cast<std::size_t>(peek_int32(data, kEpcOffset));
  return holds_array(data, kEpcOffset + 4 + epc_bytes + kBetween, kHypothesisBytes);
}

Result<Estimate> decode_tag(std::string_view channel, Bytes data) {
  if (!tag_arrays_fit(data)) return malformed("not a whole rfmvo.tag_estimate_t message", channel);
  tag_estimate_t m;
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  auto epc = Epc::from_bytes({reinterpret_cast<const std::uint8_t*>(m.epc.data()), m.epc.size()});
  if (!epc) return malformed(epc.error().what, channel);
  if (m.status < tag_estimate_t::CONVERGED || m.status > tag_estimate_t::TOO_FEW_READS)
    return malformed("unknown status " + std::to_string(m.status), channel);
  if (!fits<std::uint32_t>(m.segment) || !fits<std::uint32_t>(m.map_revision) || m.reads < 0 ||
      m.closest_utime > kMaxUtime || m.closest_utime < -kMaxUtime)
    return malformed("a count or time is out of range", channel);
  if (!finite(m.pos) || !finite(m.covariance) || !finite(m.covariance_with_log_scale) || !finite(m.pos_camera) ||
      !finite(m.covariance_camera) || !finite({m.hdop, m.bearing_sweep, m.independent_reads}))
    return malformed("a number is not finite", channel);
  TagEstimate tag;
  tag.time = DeviceTime::from_us(m.utime);
  tag.epc = epc.value();
  tag.status = static_cast<TagStatus>(m.status);
  tag.segment = static_cast<std::uint32_t>(m.segment);
  tag.map_revision = static_cast<std::uint32_t>(m.map_revision);
  tag.p_W_X_m = vector_of(m.pos);
  tag.covariance_m2 = matrix_of(m.covariance);
  tag.covariance_with_log_scale_m = vector_of(m.covariance_with_log_scale);
  tag.closest_approach = DeviceTime::from_us(m.closest_utime);
  tag.p_C_X_m = vector_of(m.pos_camera);
  tag.covariance_C_m2 = matrix_of(m.covariance_camera);
  tag.hdop = m.hdop;
  tag.bearing_sweep_rad = m.bearing_sweep;
  tag.independent_reads = m.independent_reads;
  tag.reads = static_cast<std::uint32_t>(m.reads);
  for (const tag_hypothesis_t& h : m.hypotheses) {
    auto hypothesis = hypothesis_of(h, channel);
    if (!hypothesis) return hypothesis.error();
    tag.hypotheses.push_back(std::move(hypothesis).value());
  }
  return Estimate(std::move(tag));
}

Result<Estimate> decode_scale(std::string_view channel, Bytes data) {
  scale_t m{};
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  if (!fits<std::uint32_t>(m.segment)) return malformed("segment is out of range", channel);
  if (!finite({m.m_per_unit, m.log_sigma})) return malformed("a number is not finite", channel);
  return Estimate(ScaleEstimate{DeviceTime::from_us(m.utime), static_cast<std::uint32_t>(m.segment), m.observable != 0,
                                m.m_per_unit, m.log_sigma});
}

Result<MetricPose> metric_pose_of(const metric_pose_t& m, std::string_view channel) {
  if (!fits<std::uint32_t>(m.segment) || !fits<std::uint32_t>(m.map_revision) || m.utime > kMaxUtime ||
      m.utime < -kMaxUtime)
    return malformed("a count or time is out of range", channel);
  if (!finite(m.pos) || !finite(m.covariance)) return malformed("a number is not finite", channel);
  if (!is_unit(m.orientation)) return malformed("orientation is not a unit quaternion", channel);
  MetricPose pose;
  pose.time = DeviceTime::from_us(m.utime);
  pose.segment = static_cast<std::uint32_t>(m.segment);
  pose.map_revision = static_cast<std::uint32_t>(m.map_revision);
  pose.T_W_C = {quaternion_of(m.orientation), vector_of(m.pos)};
  pose.covariance = matrix_of(m.covariance);
  return pose;
}

Result<Estimate> decode_metric_pose(std::string_view channel, Bytes data) {
  metric_pose_t m;
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  auto pose = metric_pose_of(m, channel);
  if (!pose) return pose.error();
  return Estimate(std::move(pose).value());
}

Result<Estimate> decode_trajectory(std::string_view channel, Bytes data) {
  if (!holds_array(data, kHashBytes + 8 * 3, kMetricPoseBytes))
    return malformed("not a whole rfmvo.trajectory_t message", channel);
  trajectory_t m;
  if (const Status s = unpack(m, data, channel); !s) return s.error();
  if (!fits<std::uint32_t>(m.segment) || !fits<std::uint32_t>(m.map_revision))
    return malformed("a count is out of range", channel);
  Trajectory trajectory;
  trajectory.time = DeviceTime::from_us(m.utime);
  trajectory.segment = static_cast<std::uint32_t>(m.segment);
  trajectory.map_revision = static_cast<std::uint32_t>(m.map_revision);
  trajectory.poses.reserve(m.poses.size());
  for (const metric_pose_t& p : m.poses) {
    auto pose = metric_pose_of(p, channel);
    if (!pose) return pose.error();
    trajectory.poses.push_back(std::move(pose).value());
  }
  return Estimate(std::move(trajectory));
}

Result<Estimate> decode_map_revision(std::string_view channel, Bytes data) {
  map_revision_t m;
  if (const Status s = unpack(m, data, channel, {kHashBytes + 8 + 8, 1}); !s) return s.error();
  if (!fits<std::uint32_t>(m.revision)) return malformed("revision is out of range", channel);
  return Estimate(
      MapRevision{DeviceTime::from_us(m.utime), static_cast<std::uint32_t>(m.revision), std::move(m.reason)});
}

Result<Estimate> decode_health(std::string_view channel, Bytes data) {
  constexpr std::size_t kLastFaultOffset = kHashBytes + 8 + 1 + 8 + 4 + 8 * 5 + 4 * 2 + 8;
  health_t m;
  if (const Status s = unpack(m, data, channel, {kLastFaultOffset, 1}); !s) return s.error();
  if (m.vo_status < camera_pose_t::INITIALISING || m.vo_status > camera_pose_t::LOST)
    return malformed("unknown vo_status " + std::to_string(m.vo_status), channel);
  if (!fits<std::uint32_t>(m.segment) || m.inliers < 0 || m.frames < 0 || m.poses < 0 || m.reads < 0 ||
      m.reads_without_pose < 0 || m.reads_rejected < 0 || m.tags < 0 || m.tags_located < 0 || m.faults < 0)
    return malformed("a count is out of range", channel);
  Health health;
  health.time = DeviceTime::from_us(m.utime);
  health.vo_status = static_cast<VoStatus>(m.vo_status);
  health.segment = static_cast<std::uint32_t>(m.segment);
  health.inliers = m.inliers;
  health.frames = static_cast<std::uint64_t>(m.frames);
  health.poses = static_cast<std::uint64_t>(m.poses);
  health.reads = static_cast<std::uint64_t>(m.reads);
  health.reads_without_pose = static_cast<std::uint64_t>(m.reads_without_pose);
  health.reads_rejected = static_cast<std::uint64_t>(m.reads_rejected);
  health.tags = static_cast<std::uint32_t>(m.tags);
  health.tags_located = static_cast<std::uint32_t>(m.tags_located);
  health.faults = static_cast<std::uint64_t>(m.faults);
  health.last_fault = std::move(m.last_fault);
  auto reader = reader_status_of(m.reader, channel);
  if (!reader) return reader.error();
  health.reader = reader.value();
  return Estimate(std::move(health));
}

struct EstimateChannel {
  std::string_view name;
  Result<Estimate> (*decode)(std::string_view channel, Bytes data);
};

constexpr EstimateChannel kEstimateChannels[] = {
    {"VO_POSE", decode_vo_pose},       {"TAG", decode_tag},
    {"SCALE", decode_scale},           {"METRIC_POSE", decode_metric_pose},
    {"TRAJECTORY", decode_trajectory}, {"MAP_REVISION", decode_map_revision},
    {"HEALTH", decode_health},
};

const EstimateChannel* find_channel(std::string_view channel, std::string_view prefix) {
  if (!channel.starts_with(prefix)) return nullptr;
  for (const EstimateChannel& c : kEstimateChannels)
    if (c.name == channel.substr(prefix.size())) return &c;
  return nullptr;
}

}  // namespace

std::vector<LcmMessage> encode(const Estimate& estimate, std::string_view prefix) {
  return std::visit([prefix](const auto& e) { return encode_one(e, prefix); }, estimate);
}

bool is_estimate_channel(std::string_view channel, std::string_view prefix) {
  return find_channel(channel, prefix) != nullptr;
}

Result<Estimate> decode_estimate(std::string_view channel, Bytes data, std::string_view prefix) {
  const EstimateChannel* found = find_channel(channel, prefix);
  if (found == nullptr) return malformed("not a channel of estimates", channel);
  return found->decode(channel, data);
}

}  // namespace rfmvo
