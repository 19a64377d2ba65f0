// What a reader says unasked: reports of tags, events.
#include <cmath>
#include <string>

#include "edges/llrp/decoder.hpp"
#include "edges/llrp/reader_session.hpp"

namespace rfmvo::llrp {
namespace {

// ConnectionAttemptStatusType, LLRP 1.0.1 section 13.2.6.13.
constexpr std::uint16_t kConnectionSuccess = 0, kAnotherConnectionAttempted = 4;
constexpr std::uint8_t kAntennaConnected = 1;
constexpr std::uint8_t kEndOfRoSpec = 1;

std::string greeting_text(std::uint16_t status) {
  switch (status) {
    case 1:
      return "the reader keeps a connection that it has made itself";
    case 2:
      return "another client is connected to the reader";
    case 3:
      return "the reader refuses the connection";
    default:
      return "the reader refuses the connection with status " + std::to_string(status);
  }
}

std::string loss_text(const TagReportCounts& before, const TagReportCounts& now) {
  if (now.without_phase > before.without_phase) return "tags are reported without a phase";
  if (now.without_channel > before.without_channel) return "tags are reported without a channel of the reader's table";
  if (now.without_time > before.without_time) return "tags are reported without a time";
  if (now.without_port > before.without_port) return "tags are reported without an antenna";
  return "tags are reported without an EPC of 1 to 62 bytes";
}

}  // namespace

void ReaderSession::on_reader_event(DeviceTime now, const ReaderEventNotificationData& data) {
  if (data.connection_attempt_event) {
    if (const auto* utc = std::get_if<UTCTimestamp>(&data.timestamp)) observe(now, StampKind::kUtc, utc->microseconds);
    if (const auto* up = std::get_if<Uptime>(&data.timestamp)) observe(now, StampKind::kUptime, up->microseconds);
    return on_greeting(now, data.connection_attempt_event->status);
  }
  if (data.connection_close_event) return end_connection(now, "the reader closes the connection");
  if (const auto& antenna = data.antenna_event)
    fault(now, "antenna " + std::to_string(antenna->antenna_id) +
                   (antenna->event_type == kAntennaConnected ? " is connected" : " is disconnected"));
  if (data.report_buffer_overflow_error_event) fault(now, "the reader's buffer has overflowed: reports are lost");
  if (const auto& full = data.report_buffer_level_warning_event)
    fault(now, "the reader's buffer is " + std::to_string(full->report_buffer_percentage_full) + " % full");
  if (const auto& exception = data.reader_exception_event)
    fault(now, "exception: " + (exception->message.empty() ? "without a message" : exception->message));
  const auto& spec = data.ro_spec_event;
  if (spec && state_ == State::kReading && spec->ro_spec_id == kRoSpecId && spec->event_type == kEndOfRoSpec)
    end_connection(now, "the reader has ended reading");
}

void ReaderSession::on_greeting(DeviceTime now, std::uint16_t status) {
  if (status == kAnotherConnectionAttempted) return fault(now, "another client has tried to connect");
  if (state_ != State::kGreeting) return;
  if (status != kConnectionSuccess) return end_connection(now, greeting_text(status));
  state_ = State::kSettingUp;
  requests_ = {capabilities_request()};
  next_request(now);
}

void ReaderSession::on_report(DeviceTime now, const RoAccessReport& report) {
  if (!reports_) return;
  const TagReportCounts before = reports_->counts();
  for (const TagReportData& tag : report.tag_report_data) {
    auto reported = reports_->on(tag);
    if (!reported) continue;
    TagRead& read = reported->read;
    observe(now, reported->stamp, read.reader_time);
    read.time = clock_.to_device(read.reader_time);
    events_.emplace_back(read);
  }
  const std::uint64_t lost = reports_->counts().lost() - before.lost();
  status_.reports_lost += lost;
  if (lost > 0) fault(now, loss_text(before, reports_->counts()));
}

void ReaderSession::observe(DeviceTime now, StampKind kind, std::uint64_t stamp_us) {
  if (stamp_us <= kMaxStamp_us) observe(now, kind, ReaderTime::from_us(static_cast<std::int64_t>(stamp_us)));
}

void ReaderSession::observe(DeviceTime now, StampKind kind, ReaderTime stamp) {
  if (kind != clock_kind_) clock_.forget();
  clock_kind_ = kind;
  const auto step = clock_.observe(stamp, now);
  if (!step) return;
  ++status_.clock_steps;
  const double step_s = step->seconds();
  fault(now, "the reader's clock was set " + std::string(step_s > 0 ? "forward" : "back") + " by " +
                 std::to_string(std::abs(step_s)) + " s");
}

}  // namespace rfmvo::llrp
