#include "edges/llrp/tag_reports.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "edges/llrp/vendor.hpp"

namespace rfmvo::llrp {
namespace {

constexpr int kCentiPerUnit = 100;

template <class T>
void carry(const std::optional<T>& reported, std::optional<T>& last) {
  if (reported) last = reported;
}

std::optional<Epc> epc_of(const EPCParameter& parameter) {
  std::span<const std::uint8_t> bytes;
  if (const auto* any = std::get_if<EPCData>(&parameter)) bytes = any->epc.bytes;
  if (const auto* fixed = std::get_if<EPC_96>(&parameter)) bytes = fixed->epc;
  auto epc = Epc::from_bytes(bytes);
  return epc ? std::optional(epc.value()) : std::nullopt;
}

std::optional<Phase> phase_of(const std::vector<Custom>& customs, PhaseSign sign) {
  std::uint16_t turn_q16 = 0;
  if (const auto impinj = unpack<ImpinjRFPhaseAngle>(customs))
    turn_q16 = static_cast<std::uint16_t>(impinj->phase << (16 - ImpinjRFPhaseAngle::kTurnBits));
  else if (const auto zebra = unpack<MotoTagPhase>(customs))
    turn_q16 = static_cast<std::uint16_t>(zebra->phase);
  else
    return std::nullopt;
  if (sign == PhaseSign::kFalls) turn_q16 = static_cast<std::uint16_t>(-turn_q16);
  return Phase{turn_q16};
}

std::int16_t rssi_of(const TagReportData& report, const TagReportData& last) {
  if (const auto fine = unpack<ImpinjPeakRSSI>(report.customs)) return fine->rssi_cdbm;
  return static_cast<std::int16_t>(last.peak_rssi ? last.peak_rssi->peak_rssi * kCentiPerUnit : 0);
}

struct Stamp {
  std::uint64_t us;
  StampKind kind;
};

std::optional<Stamp> stamp_of(const TagReportData& last) {
  std::optional<Stamp> stamp;
  if (last.last_seen_timestamp_uptime) stamp = {last.last_seen_timestamp_uptime->microseconds, StampKind::kUptime};
  if (last.first_seen_timestamp_uptime) stamp = {last.first_seen_timestamp_uptime->microseconds, StampKind::kUptime};
  if (last.last_seen_timestamp_utc) stamp = {last.last_seen_timestamp_utc->microseconds, StampKind::kUtc};
  if (last.first_seen_timestamp_utc) stamp = {last.first_seen_timestamp_utc->microseconds, StampKind::kUtc};
  return stamp && stamp->us <= kMaxStamp_us ? stamp : std::nullopt;
}

}  // namespace

std::optional<ReportedRead> TagReports::on(const TagReportData& report) {
  carry(report.antenna_id, last_.antenna_id);
  carry(report.channel_index, last_.channel_index);
  carry(report.peak_rssi, last_.peak_rssi);
  carry(report.first_seen_timestamp_utc, last_.first_seen_timestamp_utc);
  carry(report.first_seen_timestamp_uptime, last_.first_seen_timestamp_uptime);
  carry(report.last_seen_timestamp_utc, last_.last_seen_timestamp_utc);
  carry(report.last_seen_timestamp_uptime, last_.last_seen_timestamp_uptime);
  carry(report.tag_seen_count, last_.tag_seen_count);

  const auto lost = [](std::uint64_t& count) {
    ++count;
    return std::nullopt;
  };
  const auto epc = epc_of(report.epc_parameter);
  if (!epc) return lost(counts_.without_epc);
  const int port = last_.antenna_id ? last_.antenna_id->antenna_id : 0;
  if (port < 1 || port > std::numeric_limits<std::uint8_t>::max()) return lost(counts_.without_port);
  const auto frequency_hz = channels_.frequency_hz(last_.channel_index ? last_.channel_index->channel_index : 0);
  if (!frequency_hz) return lost(counts_.without_channel);
  const auto stamp = stamp_of(last_);
  if (!stamp) return lost(counts_.without_time);
  const auto phase = phase_of(report.customs, sign_);
  if (!phase) return lost(counts_.without_phase);

  ++counts_.reads;
  TagRead read;
  read.reader_time = ReaderTime::from_us(static_cast<std::int64_t>(stamp->us));
  read.epc = *epc;
  read.port = static_cast<std::uint8_t>(port);
  read.phase = *phase;
  read.frequency_hz = *frequency_hz;
  read.rssi_cdbm = rssi_of(report, last_);
  // Phase belongs to this singulation only if there was but one: a reader that states no count (but was asked)
  // has seen the tag once per report, as the client asks for N = 1.
  read.seen_count = last_.tag_seen_count ? last_.tag_seen_count->tag_count : std::uint16_t{1};
  if (const auto doppler = unpack<ImpinjRFDopplerFrequency>(report.customs))
    read.doppler_hz_q4 = doppler->doppler_hz_q4;
  return ReportedRead{read, stamp->kind};
}

}  // namespace rfmvo::llrp
