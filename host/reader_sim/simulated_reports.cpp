// What a simulated reader says by itself: keepalives, events, reports of tags.
#include <algorithm>
#include <limits>

#include "edges/llrp/vendor.hpp"
#include "reader_sim/simulated_reader.hpp"

namespace rfmvo::reader_sim {

using namespace llrp;

namespace {

constexpr std::uint16_t kBufferFillWarnings = 3, kAntennaEvents = 8;
constexpr std::uint8_t kAntennaDisconnected = 0;
constexpr std::int64_t kYear2000_us = 946'684'800'000'000;
constexpr int kImpinjCountsShift = 16 - ImpinjRFPhaseAngle::kTurnBits;
constexpr int kCentiPerUnit = 100;

const AISpec* ai_spec_of(const ROSpec& spec) {
  for (const SpecParameter& part : spec.spec_parameters)
    if (const auto* ai_spec = std::get_if<AISpec>(&part)) return ai_spec;
  return nullptr;
}

template <class T>
void keep_changed(std::optional<T>& now, std::optional<T>& last, auto member) {
  if (!now) return;
  const bool same = last && (*last).*member == (*now).*member;
  last = now;
  if (same) now.reset();
}

EPCParameter epc_parameter(const std::vector<std::uint8_t>& epc) {
  EPC_96 fixed;
  if (epc.size() != fixed.epc.size()) return EPCData{{static_cast<std::uint16_t>(8 * epc.size()), epc}};
  std::copy(epc.begin(), epc.end(), fixed.epc.begin());
  return fixed;
}

}  // namespace

ReaderTime SimulatedReader::reader_time(DeviceTime time) const {
  const std::int64_t uptime_us = (time - booted_.value_or(time)).ns / 1000;
  if (model_.troubles.uptime_only) return ReaderTime::from_us(uptime_us);
  return ReaderTime::from_us(model_.troubles.year_2000 ? kYear2000_us + uptime_us : time.us());
}

Timestamp SimulatedReader::timestamp(DeviceTime now) const {
  const auto us = static_cast<std::uint64_t>(reader_time(now).us());
  if (model_.troubles.uptime_only) return Uptime{us};
  return UTCTimestamp{us};
}

bool SimulatedReader::wanted(std::uint16_t event_type) const {
  const auto found = events_.find(event_type);
  return found != events_.end() && found->second;
}

void SimulatedReader::tell(DeviceTime now, ReaderEventNotificationData data, Connection connection) {
  data.timestamp = timestamp(now);
  send(connection, next_id_++, ReaderEventNotification{std::move(data)});
}

void SimulatedReader::send(std::uint32_t id, Body body) { send(*client_, id, std::move(body)); }

void SimulatedReader::send(Connection connection, std::uint32_t id, Body body, bool close) {
  if (silent_ && client_ == connection && !close) return;
  output_.push_back({connection, encode({id, std::move(body)}), close});
}

DeviceTime SimulatedReader::deadline() const {
  DeviceTime due{std::numeric_limits<std::int64_t>::max()};
  if (!client_) return due;
  if (keepalive_.ns > 0) due = std::min(due, next_keepalive_);
  if (active() && next_read_ < model_.reads.size())
    due = std::min(due, reads_from_ + Duration{model_.reads[next_read_].time.ns});
  return due;
}

void SimulatedReader::on_time(DeviceTime now) {
  if (!client_) return;
  if (keepalive_.ns > 0 && now >= next_keepalive_) {
    if (!model_.troubles.no_keepalives) send(next_id_++, Keepalive{});
    next_keepalive_ = std::max(next_keepalive_ + keepalive_, now);
  }
  if (!active()) return;
  play_troubles(now);
  report_due(now);
}

void SimulatedReader::play_troubles(DeviceTime now) {
  const Troubles& troubles = model_.troubles;
  const auto since = [&](const std::optional<double>& s) {
    return s && now >= active_since_ + Duration::from_seconds(*s);
  };
  if (since(troubles.silent_after_s)) silent_ = true;
  if (since(troubles.overflow_after_s) && !std::exchange(told_overflow_, true) && wanted(kBufferFillWarnings)) {
    ReaderEventNotificationData data;
    data.report_buffer_overflow_error_event.emplace();
    tell(now, data, *client_);
  }
  if (since(troubles.antenna_lost_after_s) && !std::exchange(told_antenna_, true) && wanted(kAntennaEvents)) {
    ReaderEventNotificationData data;
    data.antenna_event = AntennaEvent{kAntennaDisconnected, 1};
    tell(now, data, *client_);
  }
}

// Reads whose time passed while nothing was active never happened.
void SimulatedReader::report_due(DeviceTime now) {
  while (next_read_ < model_.reads.size()) {
    TagRead read = model_.reads[next_read_];
    read.time = reads_from_ + Duration{read.time.ns};
    if (read.time > now) return;
    ++next_read_;
    const bool lost = told_antenna_ && read.port == 1;
    if (read.time >= active_since_ && selected(read.port) && !lost) report(read);
    if (next_read_ == model_.reads.size() && model_.loop) {
      reads_from_ = reads_from_ + Duration{model_.reads.back().time.ns};
      next_read_ = 0;
    }
  }
}

bool SimulatedReader::selected(std::uint8_t port) const {
  const AISpec* spec = ai_spec_of(spec_);
  if (spec == nullptr || port > model_.antennas) return false;
  return std::any_of(spec->antenna_ids.begin(), spec->antenna_ids.end(),
                     [port](std::uint16_t id) { return id == 0 || id == port; });
}

void SimulatedReader::report(const TagRead& read) {
  int count = 1;
  if (model_.troubles.accumulate > 1) {
    int& sum = sums_[read.epc.hex() + "/" + std::to_string(read.port)];
    if (++sum < model_.troubles.accumulate) return;
    count = std::exchange(sum, 0);
  }
  buffer_.push_back(tag_report(read, static_cast<std::uint16_t>(count)));
  const std::uint16_t n = spec_.ro_report_spec ? spec_.ro_report_spec->n : std::uint16_t{0};
  const bool by_count = spec_.ro_report_spec && spec_.ro_report_spec->ro_report_trigger != 0 && n > 0;
  if (by_count && buffer_.size() >= n) flush_reports(false);
}

void SimulatedReader::flush_reports(bool even_if_empty) {
  if (!client_ || (buffer_.empty() && !even_if_empty)) return;
  RoAccessReport report;
  report.tag_report_data = std::exchange(buffer_, {});
  send(next_id_++, std::move(report));
}

TagReportData SimulatedReader::tag_report(const TagRead& read, std::uint16_t seen_count) {
  TagReportData tag;
  std::vector<std::uint8_t> epc(read.epc.bytes().begin(), read.epc.bytes().end());
  if (model_.troubles.long_epc) epc.insert(epc.end(), {0xAB, 0xCD, 0xEF, 0x01});
  tag.epc_parameter = epc_parameter(epc);
  TagRead truth = read;
  truth.epc = Epc::from_bytes(epc).value();
  truth.reader_time = reader_time(read.time);
  truth.seen_count = seen_count;
  reported_.push_back(truth);
  select_parameters(truth, tag);
  select_extensions(truth, tag);
  if (model_.troubles.omit_unchanged) omit_unchanged(tag);
  return tag;
}

void SimulatedReader::select_parameters(const TagRead& read, TagReportData& tag) const {
  static const TagReportContentSelector kAll{true, true, true, true, true, true, true, true, true, true, {}};
  const TagReportContentSelector& select =
      spec_.ro_report_spec ? spec_.ro_report_spec->tag_report_content_selector : kAll;
  const auto us = static_cast<std::uint64_t>(read.reader_time.us());
  const auto channel = std::find(model_.channels_khz.begin(), model_.channels_khz.end(), read.frequency_hz / 1000);
  if (select.enable_ro_spec_id) tag.ro_spec_id = ROSpecID{spec_.ro_spec_id};
  if (select.enable_spec_index) tag.spec_index = SpecIndex{1};
  if (select.enable_inventory_parameter_spec_id) tag.inventory_parameter_spec_id = InventoryParameterSpecID{1};
  if (select.enable_antenna_id) tag.antenna_id = AntennaID{read.port};
  if (select.enable_peak_rssi) tag.peak_rssi = PeakRSSI{static_cast<std::int8_t>(read.rssi_cdbm / kCentiPerUnit)};
  if (select.enable_channel_index)
    tag.channel_index = ChannelIndex{static_cast<std::uint16_t>(channel - model_.channels_khz.begin() + 1)};
  if (model_.troubles.uptime_only) {
    if (select.enable_first_seen_timestamp) tag.first_seen_timestamp_uptime = FirstSeenTimestampUptime{us};
    if (select.enable_last_seen_timestamp) tag.last_seen_timestamp_uptime = LastSeenTimestampUptime{us};
  } else {
    if (select.enable_first_seen_timestamp) tag.first_seen_timestamp_utc = FirstSeenTimestampUTC{us};
    if (select.enable_last_seen_timestamp) tag.last_seen_timestamp_utc = LastSeenTimestampUTC{us};
  }
  if (select.enable_tag_seen_count) tag.tag_seen_count = TagSeenCount{read.seen_count};
  tag.access_spec_id = AccessSpecID{0};  // of inventory reports, too: as R420 6.4.1
}

void SimulatedReader::select_extensions(const TagRead& read, TagReportData& tag) const {
  if (!extensions_ || !spec_.ro_report_spec) return;
  const auto selector = unpack<ImpinjTagReportContentSelector>(spec_.ro_report_spec->customs);
  if (!selector) return;
  if (const auto on = unpack<ImpinjEnablePeakRSSI>(selector->parts); on && on->mode == 1)
    tag.customs.push_back(pack(ImpinjPeakRSSI{read.rssi_cdbm}));
  if (const auto on = unpack<ImpinjEnableRFPhaseAngle>(selector->parts); on && on->mode == 1)
    tag.customs.push_back(
        pack(ImpinjRFPhaseAngle{static_cast<std::uint16_t>(read.phase.turn_q16 >> kImpinjCountsShift)}));
  if (const auto on = unpack<ImpinjEnableRFDopplerFrequency>(selector->parts); on && on->mode == 1)
    tag.customs.push_back(pack(ImpinjRFDopplerFrequency{read.doppler_hz_q4}));
}

void SimulatedReader::omit_unchanged(TagReportData& tag) {
  keep_changed(tag.antenna_id, last_.antenna_id, &AntennaID::antenna_id);
  keep_changed(tag.channel_index, last_.channel_index, &ChannelIndex::channel_index);
  keep_changed(tag.peak_rssi, last_.peak_rssi, &PeakRSSI::peak_rssi);
  keep_changed(tag.tag_seen_count, last_.tag_seen_count, &TagSeenCount::tag_count);
}

}  // namespace rfmvo::reader_sim
