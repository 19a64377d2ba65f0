// The LLRP client as a state machine: time and bytes in, bytes and events out. It has no socket and no clock; who
// owns those (reader_link.hpp, or a test) tells it what happened and does what it wants.
//
// A connection: the reader's greeting, its capabilities, the requests of reader_setup.hpp one by one, then reading.
// Whatever goes wrong on the way ends the connection with one fault that names it; the next one comes after a
// back-off with jitter that grows to 2 s and starts anew after success. Each request has a deadline that bytes
// alone do not extend, so have half-sent frames; a reader that sends no whole frame for three keepalives is gone.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "edges/llrp/frame_splitter.hpp"
#include "edges/llrp/reader_setup.hpp"
#include "edges/reader_clock.hpp"
#include "estimator/event.hpp"

namespace rfmvo::llrp {

class ReaderSession {
 public:
  // `seed` of the jitter only.
  ReaderSession(ReaderSettings settings, std::uint64_t seed);

  // What happened.
  void on_connected(DeviceTime now);
  void on_bytes(DeviceTime now, std::span<const std::uint8_t> bytes);
  void on_closed(DeviceTime now, const std::string& why);  // the connection is gone, or did not come about
  void on_time(DeviceTime now);
  void stop(DeviceTime now);  // ends reading and leaves in order, or after 1 s

  // What it wants.
  enum class Wish : std::int8_t { kNothing, kConnect, kKeep, kClose };
  [[nodiscard]] Wish wish() const { return wish_; }
  // The connection that kConnect or kClose asked for is being made, or is closed.
  void granted(DeviceTime now);
  [[nodiscard]] std::vector<std::uint8_t> take_output() { return std::exchange(output_, {}); }
  // Tag reads, faults, reader status; times are the device's.
  [[nodiscard]] std::vector<Event> take_events() { return std::exchange(events_, {}); }
  [[nodiscard]] DeviceTime deadline() const;  // on_time is due then

  [[nodiscard]] bool reading() const { return state_ == State::kReading; }
  [[nodiscard]] bool stopped() const { return state_ == State::kStopped; }
  [[nodiscard]] const ReaderClockFilter& clock() const { return clock_; }
  [[nodiscard]] const std::optional<ReaderPlan>& plan() const { return plan_; }

 private:
  enum class State : std::int8_t { kWaiting, kConnecting, kGreeting, kSettingUp, kReading, kLeaving, kStopped };

  void on_frame(DeviceTime now, std::span<const std::uint8_t> frame);
  void on_message(DeviceTime now, const Message& message);
  void on_unasked(DeviceTime now, const Message& message);
  void on_response(DeviceTime now, const Message& message);
  void on_reader_event(DeviceTime now, const ReaderEventNotificationData& data);
  void on_greeting(DeviceTime now, std::uint16_t status);
  void on_report(DeviceTime now, const RoAccessReport& report);
  void accept(DeviceTime now, const Body& response);
  void refuse(DeviceTime now, const std::string& why);
  void next_request(DeviceTime now);
  void send(std::uint32_t id, Body body);
  void observe(DeviceTime now, StampKind kind, std::uint64_t stamp_us);
  void observe(DeviceTime now, StampKind kind, ReaderTime stamp);
  void end_connection(DeviceTime now, const std::string& why);
  void fault(DeviceTime now, const std::string& text);
  void tell_status(DeviceTime now);

  const ReaderSettings settings_;
  std::mt19937_64 random_;
  State state_ = State::kWaiting;
  Wish wish_ = Wish::kConnect;
  std::vector<std::uint8_t> output_;
  std::vector<Event> events_;

  // Of the connection.
  FrameSplitter splitter_;
  std::deque<Request> requests_;  // the first one waits for its response
  std::uint32_t next_id_ = 1;
  std::uint32_t request_id_ = 0;
  std::optional<ReaderPlan> plan_;
  std::optional<TagReports> reports_;
  std::optional<DeviceTime> partial_since_;  // a frame has begun
  DeviceTime step_deadline_{};               // of the state: connection, greeting, response, retry
  DeviceTime last_frame_{};

  // Over connections.
  ReaderClockFilter clock_;
  StampKind clock_kind_ = StampKind::kUtc;
  std::map<std::string, DeviceTime> told_;  // faults, and when they were told last
  DeviceTime next_status_{};
  ReaderStatus status_;
  int failures_ = 0;  // since the last success
};

}  // namespace rfmvo::llrp
