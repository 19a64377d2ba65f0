#include "reader_sim/simulated_reader.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "edges/llrp/vendor.hpp"

namespace rfmvo::reader_sim {

using namespace llrp;

namespace {

constexpr std::uint16_t kGetSupportedVersion = 46, kSetProtocolVersion = 47;
// StatusCode, LLRP 1.0.1 section 14.2.1.
constexpr std::uint16_t kParameterError = 100, kFieldError = 101, kOverflowParameter = 105, kUnsupportedMessage = 109,
                        kUnsupportedVersion = 110, kUnsupportedParameter = 111;
// NotificationEventType and the values of the events.
constexpr std::uint16_t kRoSpecEvents = 2;
constexpr std::uint8_t kStartOfRoSpec = 0, kEndOfRoSpec = 1;
constexpr std::uint16_t kAnotherClientConnected = 2, kAnotherConnectionAttempted = 4;
constexpr std::uint8_t kImmediate = 1;

ReaderEventNotificationData connection_event(std::uint16_t status) {
  ReaderEventNotificationData data;
  data.connection_attempt_event = ConnectionAttemptEvent{status};
  return data;
}

bool is_selector(const Custom& custom) {
  return custom.vendor_identifier == kImpinj &&
         custom.parameter_subtype == ImpinjTagReportContentSelector::kExtension.subtype;
}

}  // namespace

SimulatedReader::SimulatedReader(ReaderModel model) : model_(std::move(model)) {}

void SimulatedReader::on_accept(Connection connection, DeviceTime now) {
  if (!booted_) booted_ = now;
  if (client_) {
    tell(now, connection_event(kAnotherClientConnected), connection);
    output_.back().close = true;
    return tell(now, connection_event(kAnotherConnectionAttempted), *client_);
  }
  client_ = connection;
  splitter_ = FrameSplitter();
  extensions_ = silent_ = false;
  last_ = {};
  tell(now, connection_event(0), connection);
}

void SimulatedReader::on_closed(Connection connection) {
  if (client_ != connection) return;
  client_.reset();
  extensions_ = false;
  keepalive_ = {0};
}

void SimulatedReader::reboot(DeviceTime now) {
  booted_ = now;
  client_.reset();
  forget();
}

void SimulatedReader::forget() {
  state_ = SpecState::kNone;
  events_.clear();
  keepalive_ = {0};
  buffer_.clear();
  sums_.clear();
}

void SimulatedReader::on_bytes(Connection connection, DeviceTime now, std::span<const std::uint8_t> bytes) {
  if (client_ != connection) return;
  splitter_.feed(bytes);
  while (client_) {
    const auto frame = splitter_.next();
    if (!frame) {
      // The stream is lost: say so and close.
      send(connection, 0, ErrorMessage{{{kUnsupportedVersion, frame.error().text(), {}, {}}}}, true);
      return on_closed(connection);
    }
    if (!frame.value()) return;
    on_frame(now, *frame.value());
  }
}

void SimulatedReader::on_frame(DeviceTime now, std::span<const std::uint8_t> frame) {
  const Header header = decode_header(frame).value();
  const auto decoded = decode(frame);
  if (decoded) return answer(now, header.id, decoded.value().message.body);
  const bool unknown = decoded.error().code == ErrorCode::kUnsupported;
  send(header.id, ErrorMessage{{{unknown ? kUnsupportedMessage : kParameterError, decoded.error().text(), {}, {}}}});
}

void SimulatedReader::answer(DeviceTime now, std::uint32_t id, const Body& request) {
  if (answer_about_spec(now, id, request)) return;
  if (std::holds_alternative<GetReaderCapabilities>(request)) return send(id, capabilities_of(model_));
  if (std::holds_alternative<GetReaderConfig>(request)) return send(id, configuration());
  if (const auto* set = std::get_if<SetReaderConfig>(&request)) {
    configure(now, *set);
    return send(id, SetReaderConfigResponse{});
  }
  if (std::holds_alternative<DeleteAccessSpec>(request)) return send(id, DeleteAccessSpecResponse{});
  if (std::holds_alternative<GetReport>(request)) return flush_reports(true);
  if (std::holds_alternative<KeepaliveAck>(request) || std::holds_alternative<EnableEventsAndReports>(request)) return;
  if (std::holds_alternative<CloseConnection>(request)) {
    send(*client_, id, CloseConnectionResponse{}, true);
    return on_closed(*client_);
  }
  if (const auto* custom = std::get_if<CustomMessage>(&request); custom != nullptr && enables_extensions(*custom)) {
    extensions_ = true;
    // LLRPStatus: success, no text.
    return send(id, CustomMessage{kImpinj, kImpinjEnableExtensionsResponse, {0x01, 0x1F, 0, 8, 0, 0, 0, 0}});
  }
  const auto* raw = std::get_if<RawMessage>(&request);
  const bool version = raw != nullptr && (raw->type == kGetSupportedVersion || raw->type == kSetProtocolVersion);
  if (version) return send(id, ErrorMessage{{{kUnsupportedVersion, "Unsupported version", {}, {}}}});
  send(id, ErrorMessage{{{kUnsupportedMessage, "Unsupported message", {}, {}}}});
}

bool SimulatedReader::enables_extensions(const CustomMessage& message) const {
  return message.vendor_identifier == kImpinj && message.message_subtype == kImpinjEnableExtensions &&
         !model_.troubles.no_phase;
}

// What is done to the ROSpec comes before the answer: its first event was seen to.
bool SimulatedReader::answer_about_spec(DeviceTime now, std::uint32_t id, const Body& request) {
  Body response = RawMessage{};
  if (const auto* m = std::get_if<AddRoSpec>(&request)) response = AddRoSpecResponse{{add(m->ro_spec)}};
  if (const auto* m = std::get_if<EnableRoSpec>(&request))
    response = EnableRoSpecResponse{{enable(now, m->ro_spec_id)}};
  if (const auto* m = std::get_if<DisableRoSpec>(&request))
    response = DisableRoSpecResponse{{disable(now, m->ro_spec_id)}};
  if (const auto* m = std::get_if<DeleteRoSpec>(&request))
    response = DeleteRoSpecResponse{{remove(now, m->ro_spec_id)}};
  if (const auto* m = std::get_if<StartRoSpec>(&request)) response = StartRoSpecResponse{{start(now, m->ro_spec_id)}};
  if (const auto* m = std::get_if<StopRoSpec>(&request)) response = StopRoSpecResponse{{stop(now, m->ro_spec_id)}};
  if (std::holds_alternative<GetRoSpecs>(request)) {
    GetRoSpecsResponse specs;
    if (state_ != SpecState::kNone) specs.ro_specs = {spec_};
    for (ROSpec& spec : specs.ro_specs) spec.current_state = static_cast<std::uint8_t>(state_);
    response = std::move(specs);
  }
  if (std::holds_alternative<RawMessage>(response)) return false;
  send(id, std::move(response));
  return true;
}

LLRPStatus SimulatedReader::add(const ROSpec& spec) {
  if (state_ != SpecState::kNone) return {kOverflowParameter, "There is an ROSpec already", {}, {}};
  for (const SpecParameter& part : spec.spec_parameters) {
    const auto* ai_spec = std::get_if<AISpec>(&part);
    if (ai_spec != nullptr && std::any_of(ai_spec->customs.begin(), ai_spec->customs.end(), is_selector))
      return {kUnsupportedParameter, "Selector outside of ROReportSpec", {}, {}};
  }
  spec_ = spec;
  state_ = SpecState::kDisabled;
  return {};
}

LLRPStatus SimulatedReader::enable(DeviceTime now, std::uint32_t id) {
  if (state_ == SpecState::kNone || (id != 0 && id != spec_.ro_spec_id)) return {kFieldError, "No such ROSpec", {}, {}};
  if (state_ != SpecState::kDisabled) return {};
  state_ = SpecState::kInactive;
  if (spec_.ro_boundary_spec.ro_spec_start_trigger.ro_spec_start_trigger_type == kImmediate) activate(now);
  return {};
}

LLRPStatus SimulatedReader::disable(DeviceTime now, std::uint32_t id) {
  if (id != 0 && (state_ == SpecState::kNone || id != spec_.ro_spec_id)) return {kFieldError, "No such ROSpec", {}, {}};
  if (active()) deactivate(now);
  if (state_ != SpecState::kNone) state_ = SpecState::kDisabled;
  return {};
}

LLRPStatus SimulatedReader::remove(DeviceTime now, std::uint32_t id) {
  const LLRPStatus status = disable(now, id);
  if (status.status_code == 0) state_ = SpecState::kNone;
  return status;
}

LLRPStatus SimulatedReader::start(DeviceTime now, std::uint32_t id) {
  if (state_ == SpecState::kNone || state_ == SpecState::kDisabled || id != spec_.ro_spec_id)
    return {kFieldError, "Failed to start ROSpec", {}, {}};
  if (!active()) activate(now);
  return {};
}

LLRPStatus SimulatedReader::stop(DeviceTime now, std::uint32_t id) {
  if (!active() || id != spec_.ro_spec_id) return {kFieldError, "Failed to stop ROSpec", {}, {}};
  deactivate(now);
  return {};
}

void SimulatedReader::activate(DeviceTime now) {
  state_ = SpecState::kActive;
  active_since_ = now;
  if (!started_) reads_from_ = model_.start.value_or(now);
  started_ = true;
  if (!wanted(kRoSpecEvents)) return;
  ReaderEventNotificationData data;
  data.ro_spec_event = ROSpecEvent{kStartOfRoSpec, spec_.ro_spec_id, 0};
  tell(now, data, *client_);
}

void SimulatedReader::deactivate(DeviceTime now) {
  state_ = SpecState::kInactive;
  flush_reports(true);
  if (!wanted(kRoSpecEvents) || !client_) return;
  ReaderEventNotificationData data;
  data.ro_spec_event = ROSpecEvent{kEndOfRoSpec, spec_.ro_spec_id, 0};
  tell(now, data, *client_);
}

void SimulatedReader::configure(DeviceTime now, const SetReaderConfig& set) {
  if (set.reset_to_factory_default) forget();
  if (set.reader_event_notification_spec)
    for (const auto& s : set.reader_event_notification_spec->event_notification_states)
      events_[s.event_type] = s.notification_state;
  if (!set.keepalive_spec) return;
  keepalive_ = {set.keepalive_spec->keepalive_trigger_type == 0
                    ? 0
                    : std::int64_t{set.keepalive_spec->periodic_trigger_value} * 1'000'000};
  next_keepalive_ = now;  // real readers were seen to send the first one before the response
  on_time(now);
}

GetReaderConfigResponse SimulatedReader::configuration() const {
  GetReaderConfigResponse response;
  for (std::uint16_t port = 1; port <= model_.antennas; ++port)
    response.antenna_properties.push_back({!(told_antenna_ && port == 1), port, 0});
  response.keepalive_spec = KeepaliveSpec{static_cast<std::uint8_t>(keepalive_.ns > 0),
                                          static_cast<std::uint32_t>(keepalive_.ns / 1'000'000)};
  response.events_and_reports = EventsAndReports{false};
  auto& spec = response.reader_event_notification_spec.emplace();
  for (const auto& [type, on] : events_) spec.event_notification_states.push_back({type, on});
  return response;
}

}  // namespace rfmvo::reader_sim
