#include "inspect/run_info.hpp"

#include <algorithm>

#include "edges/lcm_codec.hpp"
#include "edges/log_file.hpp"
#include "inspect/message_types.hpp"
#include "inspect/sequence.hpp"

namespace rfmvo::inspect {
namespace {

// The version stands in front, whatever follows: fingerprint, utime, then a string with its length.
std::string version_of(std::span<const std::uint8_t> start) {
  constexpr std::size_t kLengthOffset = 16, kMaxLength = 64;
  if (start.size() < kLengthOffset + 4) return "";
  std::size_t length = 0;
  for (std::size_t i = 0; i < 4; ++i) length = length << 8 | start[kLengthOffset + i];
  if (length < 1 || length > kMaxLength || length > start.size() - kLengthOffset - 4) return "";
  const auto* text = reinterpret_cast<const char*>(start.data()) + kLengthOffset + 4;
  return {text, length - 1};  // 1: the NUL
}

class Collector {
 public:
  explicit Collector(const std::string& prefix) : prefix_(prefix) {}

  void add(const LogRecord& record) {
    count(record);
    count(record, info_.channels[record.channel]);
    if (const auto sequence = sequence_of(record.data)) loss_.add(record.channel, *sequence);
    if (is_event_channel(record.channel, prefix_)) look_into(record);
  }
  void damaged(Error error) { info_.damage = std::move(error); }
  [[nodiscard]] RunInfo finish() {
    for (auto& [name, channel] : info_.channels) channel.lost = loss_.lost(name);
    return std::move(info_);
  }

 private:
  void count(const LogRecord& record) {
    if (info_.messages > 0 && record.number > next_number_) info_.lost_by_recorder += record.number - next_number_;
    next_number_ = record.number + 1;
    info_.first_us = info_.messages == 0 ? record.utime : std::min(info_.first_us, record.utime);
    info_.last_us = info_.messages == 0 ? record.utime : std::max(info_.last_us, record.utime);
    ++info_.messages;
    info_.bytes += record.data.size();
  }
  static void count(const LogRecord& record, ChannelInfo& channel) {
    const double gap_s = static_cast<double>(record.utime - channel.last_us) * 1e-6;
    if (channel.messages == 0) {
      channel.type = type_name(fingerprint_of(record.data));
      channel.first_us = record.utime;
    } else if (gap_s > channel.longest_gap_s) {
      channel.longest_gap_s = gap_s;
      channel.longest_gap_at_us = channel.last_us;
    }
    channel.last_us = std::max(channel.last_us, record.utime);
    channel.first_us = std::min(channel.first_us, record.utime);
    if (channel.messages == 0) channel.last_us = record.utime;
    ++channel.messages;
    channel.bytes += record.data.size();
  }
  void look_into(const LogRecord& record) {
    const std::string name = record.channel.substr(prefix_.size());
    if (name != "START" && name != "FAULT" && name != "READER_STATUS") return;
    if (name == "START" && info_.start) return;
    const auto event = decode_event(record.channel, record.data, prefix_);
    if (name == "START") {
      info_.start = StartInfo{version_of(record.data), {}, ""};
      if (event)
        info_.start->content = std::get<Start>(event.value());
      else
        info_.start->problem = event.error().text();
    }
    if (!event) return;
    if (const auto* fault = std::get_if<Fault>(&event.value())) info_.faults.push_back(*fault);
    if (const auto* status = std::get_if<ReaderStatus>(&event.value())) info_.reader = *status;
  }

  std::string prefix_;
  RunInfo info_;
  SequenceLoss loss_;
  std::int64_t next_number_ = 0;
};

}  // namespace

double ChannelInfo::rate_hz() const {
  const double span_s = static_cast<double>(last_us - first_us) * 1e-6;
  return messages > 1 && span_s > 0.0 ? static_cast<double>(messages - 1) / span_s : 0.0;
}

Result<RunInfo> read_run_info(const std::string& path, const std::string& prefix) {
  auto file = LogFileReader::open(path);
  if (!file) return file.error();
  Collector collector(prefix);
  for (bool any = false;; any = true) {
    auto read = file.value()->next();
    if (!read) {
      if (!any) return read.error();
      collector.damaged(read.error());
      break;
    }
    if (!read.value()) break;
    collector.add(*read.value());
  }
  return collector.finish();
}

}  // namespace rfmvo::inspect
