// An LLRP reader as a state machine: what an R420 was seen to answer, without a socket and without a clock. It has
// one client at a time, one ROSpec, and reports the tag reads that it is given when their time has come.
//
// Behaviour from captures of real readers: a greeting at once; a second client gets status 2; no protocol but
// 1.0.1 (GET_SUPPORTED_VERSION: M_UnsupportedVersion); one ROSpec; DISABLE and DELETE of all are fine when there is
// none; STOP of what does not run is M_FieldError; extensions only after they were enabled on this connection and
// only those selected in the ROReportSpec; AccessSpecID 0 in every report; an empty report at the end.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edges/llrp/codec.hpp"
#include "edges/llrp/frame_splitter.hpp"
#include "rf/tag_read.hpp"

namespace rfmvo::reader_sim {

// What is wrong with this reader.
struct Troubles {
  bool year_2000 = false;       // its clock was never set
  bool uptime_only = false;     // it has no clock
  int accumulate = 1;           // singulations of a tag in one report
  bool omit_unchanged = false;  // parameters that are as in the report before
  bool long_epc = false;        // 128 bits: four bytes are added
  bool no_keepalives = false;
  bool no_phase = false;                       // extensions are refused
  std::optional<double> silent_after_s;        // no byte any more, this long after the start of reading
  std::optional<double> overflow_after_s;      // the buffer overflows
  std::optional<double> antenna_lost_after_s;  // antenna 1 is disconnected; its reads end
};

struct ReaderModel {
  std::uint16_t antennas = 4;
  std::vector<std::uint32_t> channels_khz;  // in hop order
  std::vector<TagRead> reads;               // times are relative to the start, increasing
  std::optional<DeviceTime> start;          // of the reads; nothing: when reading starts first
  bool loop = false;                        // begin again after the last read
  Troubles troubles;
};

class SimulatedReader {
 public:
  explicit SimulatedReader(ReaderModel model);

  using Connection = int;
  void on_accept(Connection connection, DeviceTime now);
  void on_bytes(Connection connection, DeviceTime now, std::span<const std::uint8_t> bytes);
  void on_closed(Connection connection);
  void on_time(DeviceTime now);
  void reboot(DeviceTime now);  // everything is forgotten, uptime is 0; connections are for the server to cut

  struct Output {
    Connection connection = 0;
    std::vector<std::uint8_t> bytes;  // one frame
    bool close = false;               // after it
  };
  [[nodiscard]] std::vector<Output> take_output() { return std::exchange(output_, {}); }
  [[nodiscard]] DeviceTime deadline() const;  // on_time is due then; far away if nothing is

  [[nodiscard]] bool active() const { return state_ == SpecState::kActive; }
  // What has been reported, on the reader's clock, in order: the truth of a test.
  [[nodiscard]] const std::vector<TagRead>& reported() const { return reported_; }

 private:
  enum class SpecState : std::int8_t { kNone = -1, kDisabled = 0, kInactive = 1, kActive = 2 };

  void on_frame(DeviceTime now, std::span<const std::uint8_t> frame);
  void answer(DeviceTime now, std::uint32_t id, const llrp::Body& request);
  bool answer_about_spec(DeviceTime now, std::uint32_t id, const llrp::Body& request);  // false: it is about another
  [[nodiscard]] bool enables_extensions(const llrp::CustomMessage& message) const;
  llrp::LLRPStatus add(const llrp::ROSpec& spec);
  llrp::LLRPStatus enable(DeviceTime now, std::uint32_t id);
  llrp::LLRPStatus disable(DeviceTime now, std::uint32_t id);
  llrp::LLRPStatus remove(DeviceTime now, std::uint32_t id);
  llrp::LLRPStatus start(DeviceTime now, std::uint32_t id);
  llrp::LLRPStatus stop(DeviceTime now, std::uint32_t id);
  void configure(DeviceTime now, const llrp::SetReaderConfig& set);
  llrp::GetReaderConfigResponse configuration() const;
  void activate(DeviceTime now);
  void deactivate(DeviceTime now);
  void forget();
  void report_due(DeviceTime now);
  void report(const TagRead& read);
  void flush_reports(bool even_if_empty);
  void play_troubles(DeviceTime now);
  llrp::TagReportData tag_report(const TagRead& read, std::uint16_t seen_count);
  void select_parameters(const TagRead& read, llrp::TagReportData& tag) const;
  void select_extensions(const TagRead& read, llrp::TagReportData& tag) const;
  void omit_unchanged(llrp::TagReportData& tag);
  [[nodiscard]] bool selected(std::uint8_t port) const;
  [[nodiscard]] ReaderTime reader_time(DeviceTime time) const;
  [[nodiscard]] llrp::Timestamp timestamp(DeviceTime now) const;
  void tell(DeviceTime now, llrp::ReaderEventNotificationData data, Connection connection);
  [[nodiscard]] bool wanted(std::uint16_t event_type) const;
  void send(std::uint32_t id, llrp::Body body);
  void send(Connection connection, std::uint32_t id, llrp::Body body, bool close = false);

  ReaderModel model_;
  std::vector<Output> output_;
  std::optional<DeviceTime> booted_;

  // Of the connection.
  std::optional<Connection> client_;
  llrp::FrameSplitter splitter_;
  bool extensions_ = false;
  bool silent_ = false;
  std::uint32_t next_id_ = 1;
  llrp::TagReportData last_;  // as the client knows it

  // Configuration and ROSpec.
  std::map<std::uint16_t, bool> events_;
  Duration keepalive_{0};
  DeviceTime next_keepalive_{};
  SpecState state_ = SpecState::kNone;
  llrp::ROSpec spec_;
  std::vector<llrp::TagReportData> buffer_;  // of the next report
  std::map<std::string, int> sums_;          // singulations per tag and port since its last report

  // Reads.
  bool started_ = false;
  DeviceTime reads_from_{};
  DeviceTime active_since_{};
  std::size_t next_read_ = 0;
  bool told_overflow_ = false, told_antenna_ = false;
  std::vector<TagRead> reported_;
};

// The capabilities that this reader states: an R420, its tables filled from the model.
[[nodiscard]] llrp::GetReaderCapabilitiesResponse capabilities_of(const ReaderModel& model);

}  // namespace rfmvo::reader_sim
