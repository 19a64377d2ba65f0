#include "edges/journal.hpp"

#include <algorithm>

#include "edges/lcm_codec.hpp"
#include "edges/log_file.hpp"
#include "edges/recorder/segment_reader.hpp"

namespace rfmvo {

struct LogWriter::Impl {
  std::unique_ptr<LogFileWriter> file;
  std::string prefix;
};

LogWriter::LogWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LogWriter::~LogWriter() = default;

Result<std::unique_ptr<LogWriter>> LogWriter::create(const std::string& path, const std::string& prefix) {
  auto file = LogFileWriter::create(path);
  if (!file) return file.error();
  auto impl = std::make_unique<Impl>(Impl{std::move(file).value(), prefix});
  return std::unique_ptr<LogWriter>(new LogWriter(std::move(impl)));
}

Status LogWriter::write(const Event& event) {
  const LcmMessage message = encode(event, impl_->prefix);
  return impl_->file->write(message.channel, message.utime, message.data);
}

Status LogWriter::publish(const Estimate& estimate) {
  for (const LcmMessage& message : encode(estimate, impl_->prefix))
    if (const Status s = impl_->file->write(message.channel, message.utime, message.data); !s) return s;
  return Done{};
}

Status LogWriter::close() { return impl_->file->close(); }

struct JournalReader::Impl {
  std::unique_ptr<SegmentReader> file;
  std::string prefix;
  Options options;
};

JournalReader::JournalReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
JournalReader::~JournalReader() = default;

Result<std::unique_ptr<JournalReader>> JournalReader::open(const std::string& path, const std::string& prefix,
                                                           Options options) {
  auto file = SegmentReader::open(path);
  if (!file) return file.error();
  auto impl = std::make_unique<Impl>(Impl{std::move(file).value(), prefix, options});
  return std::unique_ptr<JournalReader>(new JournalReader(std::move(impl)));
}

namespace {

// An error in what a record holds, with the record's place in front.
Error in_record(const SegmentReader& file, const LogRecord& record, const Error& error) {
  return {error.code, error.text(), file.where(record.offset)};
}

}  // namespace

Result<std::optional<Event>> JournalReader::next() {
  const SegmentReader& file = *impl_->file;
  while (true) {
    auto read = impl_->file->next();
    if (!read) return read.error();
    if (!read.value()) return std::optional<Event>();
    const LogRecord& record = *read.value();
    if (!is_event_channel(record.channel, impl_->prefix)) continue;
    if (!impl_->options.decode_frames && record.channel == impl_->prefix + "FRAME") continue;
    auto event = decode_event(record.channel, record.data, impl_->prefix);
    if (!event) return in_record(file, record, event.error());
    std::optional<Event> result(std::move(event).value());
    if (auto* frame = std::get_if<Frame>(&*result))
      if (const Status s = decode_image(*frame); !s) return in_record(file, record, s.error());
    return result;
  }
}

Result<JournalSummary> summarise_journal(const std::string& path, const std::string& prefix) {
  auto file = SegmentReader::open(path);
  if (!file) return file.error();
  JournalSummary summary;
  bool started = false;
  while (true) {
    auto read = file.value()->next(!started);
    if (!read) return read.error();
    if (!read.value()) break;
    const LogRecord& record = *read.value();
    if (!is_event_channel(record.channel, prefix)) continue;
    const std::string_view name = std::string_view(record.channel).substr(prefix.size());
    if (name == "START" && !started) {
      auto event = decode_event(record.channel, record.data, prefix);
      if (!event) return in_record(*file.value(), record, event.error());
      summary.start = std::get<Start>(std::move(event).value());
      started = true;
    }
    const DeviceTime time = DeviceTime::from_us(record.utime);
    summary.first = summary.events == 0 ? time : std::min(summary.first, time);
    summary.last = summary.events == 0 ? time : std::max(summary.last, time);
    ++summary.events;
    summary.frames += name == "FRAME" ? 1 : 0;
    summary.camera_poses += name == "CAMERA_POSE" ? 1 : 0;
    summary.tag_reads += name == "TAG_READ" ? 1 : 0;
  }
  if (!started) return Error{ErrorCode::kMalformed, "not a journal: it holds no " + prefix + "START event", path};
  return summary;
}

Status check_pose_source(const JournalSummary& journal, const Config& config, const std::string& path) {
  const bool frames = config.estimator.pose_source == "frames";
  if ((frames ? journal.frames : journal.camera_poses) > 0) return Done{};
  const std::uint64_t others = frames ? journal.camera_poses : journal.frames;
  if (others == 0) return Error{ErrorCode::kMalformed, "holds neither frames nor camera poses", path};
  return Error{ErrorCode::kMalformed,
               frames ? "holds no frames, but camera poses: estimator.pose_source = \"poses\" would do"
                      : "holds no camera poses, but frames: estimator.pose_source = \"frames\" would do",
               path};
}

Result<std::vector<Estimate>> read_estimates(const std::string& path, const std::string& prefix) {
  auto file = SegmentReader::open(path);
  if (!file) return file.error();
  std::vector<Estimate> estimates;
  while (true) {
    auto read = file.value()->next();
    if (!read) return read.error();
    if (!read.value()) return estimates;
    const LogRecord& record = *read.value();
    if (!is_estimate_channel(record.channel, prefix)) continue;
    auto estimate = decode_estimate(record.channel, record.data, prefix);
    if (!estimate) return in_record(*file.value(), record, estimate.error());
    estimates.push_back(std::move(estimate).value());
  }
}

}  // namespace rfmvo
