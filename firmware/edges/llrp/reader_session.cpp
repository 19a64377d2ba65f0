#include "edges/llrp/reader_session.hpp"

#include <algorithm>
#include <utility>

#include "edges/llrp/vendor.hpp"

namespace rfmvo::llrp {
namespace {

constexpr Duration seconds(double s) { return Duration::from_seconds(s); }

constexpr Duration kConnectWithin = seconds(5.0);
constexpr Duration kGreetWithin = seconds(10.0);  // after accept; LLRP readers take up to 5 s
constexpr Duration kAnswerWithin = seconds(5.0);  // a factory reset is the slowest: 1 to 2 s
constexpr Duration kFrameWithin = seconds(5.0);   // from its first byte to its last
constexpr Duration kLeaveWithin = seconds(1.0);
constexpr Duration kStatusEvery = seconds(1.0);
constexpr Duration kSameFaultEvery = seconds(60.0);
constexpr int kKeepalivesMissed = 3;
constexpr double kFirstRetry_s = 0.25, kLastRetry_s = 2.0;
constexpr double kJitter = 0.25;  // of the back-off, either way
constexpr std::size_t kMaxToldFaults = 64;
constexpr std::uint16_t kSuccess = 0;

const LLRPStatus* status_in(const Body& body) {
  return std::visit(
      []<class T>(const T& m) -> const LLRPStatus* {
        if constexpr (requires { m.llrp_status; })
          return &m.llrp_status;
        else
          return nullptr;
      },
      body);
}

std::uint16_t type_of(const Body& body) {
  return std::visit(
      []<class T>(const T& m) {
        if constexpr (std::is_same_v<T, RawMessage>)
          return m.type;
        else
          return T::kName.type;
      },
      body);
}

// What an extension's answer carries in front, if anything.
LLRPStatus status_of(const CustomMessage& message) {
  Decoding decoding;
  decoding.path.push_back("CUSTOM_MESSAGE");
  StatusOnly body;
  decode_into(body, message.data, decoding);
  return decoding.error.empty() ? body.llrp_status : LLRPStatus{};
}

}  // namespace

ReaderSession::ReaderSession(ReaderSettings settings, std::uint64_t seed)
    : settings_(std::move(settings)), random_(seed) {}

void ReaderSession::granted(DeviceTime now) {
  if (wish_ == Wish::kClose) {
    wish_ = Wish::kNothing;
    return;
  }
  wish_ = Wish::kKeep;
  state_ = State::kConnecting;
  step_deadline_ = now + kConnectWithin;
}

void ReaderSession::on_connected(DeviceTime now) {
  splitter_ = FrameSplitter();
  requests_.clear();
  output_.clear();
  plan_.reset();
  reports_.reset();
  partial_since_.reset();
  last_frame_ = now;
  clock_.suspect();
  state_ = State::kGreeting;
  step_deadline_ = now + kGreetWithin;
}

void ReaderSession::on_closed(DeviceTime now, const std::string& why) {
  if (state_ == State::kWaiting || state_ == State::kStopped) return;
  end_connection(now, why);
  if (wish_ == Wish::kClose) wish_ = Wish::kNothing;  // it is closed
}

void ReaderSession::end_connection(DeviceTime now, const std::string& why) {
  const bool leaving = state_ == State::kLeaving;
  output_.clear();
  status_.reading = false;
  wish_ = Wish::kClose;
  state_ = leaving ? State::kStopped : State::kWaiting;
  if (leaving) return;
  fault(now, why);
  tell_status(now);
  const double base_s = std::min(kFirstRetry_s * static_cast<double>(1 << std::min(failures_, 8)), kLastRetry_s);
  std::uniform_real_distribution<double> jitter(1.0 - kJitter, 1.0 + kJitter);
  ++failures_;
  step_deadline_ = now + seconds(base_s * jitter(random_));
}

DeviceTime ReaderSession::deadline() const {
  if (state_ == State::kStopped) return next_status_;
  DeviceTime due = std::min(next_status_, state_ == State::kReading ? next_status_ : step_deadline_);
  if (partial_since_) due = std::min(due, *partial_since_ + kFrameWithin);
  if (state_ == State::kReading)
    due = std::min(due, last_frame_ + Duration{settings_.keepalive.ns * kKeepalivesMissed});
  return due;
}

void ReaderSession::on_time(DeviceTime now) {
  if (now >= next_status_) tell_status(now);
  switch (state_) {
    case State::kWaiting:
      if (now >= step_deadline_ && wish_ == Wish::kNothing) wish_ = Wish::kConnect;
      return;
    case State::kStopped:
      return;
    case State::kConnecting:
      if (now >= step_deadline_) end_connection(now, "no connection within 5 s");
      return;
    case State::kGreeting:
      if (now >= step_deadline_) return end_connection(now, "the reader has not greeted within 10 s");
      break;
    case State::kSettingUp:
      if (now >= step_deadline_)
        return end_connection(now, std::string(name_of(requests_.front().body)) + ": no answer within 5 s");
      break;
    case State::kReading:
      if (now >= last_frame_ + Duration{settings_.keepalive.ns * kKeepalivesMissed})
        return end_connection(now, "the reader has been silent for three keepalives");
      break;
    case State::kLeaving:
      if (now >= step_deadline_) return end_connection(now, "");
      break;
  }
  if (partial_since_ && now >= *partial_since_ + kFrameWithin)
    end_connection(now, "a frame has not come to its end within 5 s");
}

void ReaderSession::on_bytes(DeviceTime now, std::span<const std::uint8_t> bytes) {
  splitter_.feed(bytes);
  while (state_ != State::kWaiting && state_ != State::kStopped) {
    const auto frame = splitter_.next();
    if (!frame) return end_connection(now, "not LLRP: " + frame.error().text());
    if (!frame.value()) break;
    partial_since_.reset();
    last_frame_ = now;
    on_frame(now, *frame.value());
  }
  if (splitter_.empty())
    partial_since_.reset();
  else if (!partial_since_)
    partial_since_ = now;
}

void ReaderSession::on_frame(DeviceTime now, std::span<const std::uint8_t> frame) {
  const auto decoded = decode(frame);
  // The stream is intact: only this message is lost.
  if (!decoded) return fault(now, "message not understood: " + decoded.error().text());
  for (const std::string& skipped : decoded.value().skipped) fault(now, "passed over: " + skipped);
  on_message(now, decoded.value().message);
}

void ReaderSession::on_message(DeviceTime now, const Message& message) {
  if (const auto* report = std::get_if<RoAccessReport>(&message.body)) return on_report(now, *report);
  if (std::holds_alternative<Keepalive>(message.body)) return send(message.id, KeepaliveAck{});
  if (const auto* event = std::get_if<ReaderEventNotification>(&message.body))
    return on_reader_event(now, event->reader_event_notification_data);
  const bool waiting = state_ == State::kSettingUp || state_ == State::kLeaving;
  const bool fits =
      waiting && !requests_.empty() && message.id == request_id_ &&
      (type_of(message.body) == requests_.front().response_type || std::holds_alternative<ErrorMessage>(message.body));
  return fits ? on_response(now, message) : on_unasked(now, message);
}

void ReaderSession::on_unasked(DeviceTime now, const Message& message) {
  if (const auto* error = std::get_if<ErrorMessage>(&message.body))
    return fault(now, "the reader complains: " + status_text(error->llrp_status));
  fault(now, "unexpected " + std::string(name_of(message.body)));
}

void ReaderSession::on_response(DeviceTime now, const Message& message) {
  const LLRPStatus* status = status_in(message.body);
  LLRPStatus custom;
  if (const auto* extension = std::get_if<CustomMessage>(&message.body)) {
    custom = status_of(*extension);
    status = &custom;
  }
  const bool refused = status != nullptr && status->status_code != kSuccess;
  if (refused || std::holds_alternative<ErrorMessage>(message.body)) {
    refuse(now, status_text(*status));
  } else {
    accept(now, message.body);
  }
  if (state_ != State::kSettingUp && state_ != State::kLeaving) return;
  requests_.pop_front();
  next_request(now);
}

void ReaderSession::refuse(DeviceTime now, const std::string& why) {
  const Request& request = requests_.front();
  if (request.refusal == Refusal::kTolerated) return;
  const std::string text = std::string(name_of(request.body)) + ": " + why;
  if (request.refusal == Refusal::kReported) return fault(now, text);
  end_connection(now, text);
}

void ReaderSession::accept(DeviceTime now, const Body& response) {
  std::string differs;
  if (const auto* capabilities = std::get_if<GetReaderCapabilitiesResponse>(&response)) {
    auto plan = plan_reader(*capabilities, settings_);
    if (!plan) return end_connection(now, plan.error().text());
    plan_ = std::move(plan).value();
    reports_.emplace(plan_->channels, settings_.phase_sign);
    requests_.insert(requests_.end(), plan_->requests.begin(), plan_->requests.end());
  } else if (const auto* specs = std::get_if<GetRoSpecsResponse>(&response)) {
    differs = difference(plan_->ro_spec, *specs);
  } else if (const auto* config = std::get_if<GetReaderConfigResponse>(&response)) {
    differs = difference(settings_, *config);
  }
  if (!differs.empty()) fault(now, "the reader has not taken a setting: " + differs);
}

void ReaderSession::next_request(DeviceTime now) {
  if (!requests_.empty()) {
    request_id_ = next_id_++;
    send(request_id_, requests_.front().body);
    if (state_ == State::kSettingUp) step_deadline_ = now + kAnswerWithin;
    return;
  }
  if (state_ == State::kLeaving) return end_connection(now, "");
  state_ = State::kReading;
  failures_ = 0;
  told_.clear();
  ++status_.connections;
  status_.reading = true;
  tell_status(now);
}

void ReaderSession::send(std::uint32_t id, Body body) {
  const auto frame = encode({id, std::move(body)});
  output_.insert(output_.end(), frame.begin(), frame.end());
}

void ReaderSession::stop(DeviceTime now) {
  if (state_ != State::kReading && state_ != State::kSettingUp) {
    wish_ = wish_ == Wish::kKeep ? Wish::kClose : Wish::kNothing;
    state_ = State::kStopped;
    return;
  }
  state_ = State::kLeaving;
  step_deadline_ = now + kLeaveWithin;
  const auto goodbye = goodbye_requests();
  requests_.assign(goodbye.begin(), goodbye.end());
  next_request(now);
}

void ReaderSession::fault(DeviceTime now, const std::string& text) {
  if (text.empty()) return;
  const auto told = told_.find(text);
  if (told != told_.end() && now - told->second < kSameFaultEvery) return;
  if (told_.size() >= kMaxToldFaults) told_.clear();
  told_[text] = now;
  events_.emplace_back(Fault{now, "reader", settings_.host + ": " + text});
}

void ReaderSession::tell_status(DeviceTime now) {
  next_status_ = now + kStatusEvery;
  status_.time = now;
  status_.clock_known = clock_.known();
  if (clock_.known()) {
    status_.clock_offset_s = clock_.offset_s();
    status_.clock_drift = clock_.drift();
    status_.clock_sigma_s = clock_.sigma().seconds();
  }
  events_.emplace_back(status_);
}

}  // namespace rfmvo::llrp
