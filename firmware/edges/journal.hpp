// Journals and results as plain LCM logs: lcm-logplayer and lcm-spy open them. A file is written
// under a temporary name and renamed when it is whole; nothing half-written is left behind.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "edges/event_io.hpp"

namespace rfmvo {

class LogWriter : public EventSink, public EstimateSink {
 public:
  // Errors: kUnwritable naming the path.
  [[nodiscard]] static Result<std::unique_ptr<LogWriter>> create(const std::string& path, const std::string& prefix);
  ~LogWriter() override;  // a log that was not closed is removed

  [[nodiscard]] Status write(const Event& event) override;
  [[nodiscard]] Status publish(const Estimate& estimate) override;
  [[nodiscard]] Status close();  // flush, fsync, rename

 private:
  struct Impl;
  explicit LogWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Events of a journal in recorded order, through all its segments (recorder/journal_names.hpp). Channels of others are
// skipped; a truncated or foreign file is an error that names the file and the byte offset.
class JournalReader : public EventSource {
 public:
  struct Options {
    bool decode_frames = true;  // false: Frame events are skipped (replay from poses)
  };
  [[nodiscard]] static Result<std::unique_ptr<JournalReader>> open(const std::string& path, const std::string& prefix,
                                                                   Options options);
  ~JournalReader() override;
  [[nodiscard]] Result<std::optional<Event>> next() override;

 private:
  struct Impl;
  explicit JournalReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

struct JournalSummary {
  Start start;  // the first one
  std::uint64_t events = 0, frames = 0, camera_poses = 0, tag_reads = 0;
  DeviceTime first, last;  // of the earliest and the latest event
};

// Goes through the whole file without decoding images. Same errors as JournalReader; no Start is
// kMalformed.
[[nodiscard]] Result<JournalSummary> summarise_journal(const std::string& path, const std::string& prefix);

// Can the journal feed the configured estimator.pose_source? The error says which one it can feed.
[[nodiscard]] Status check_pose_source(const JournalSummary& journal, const Config& config, const std::string& path);

// Every estimate of a result log, in order. Same errors as JournalReader.
[[nodiscard]] Result<std::vector<Estimate>> read_estimates(const std::string& path, const std::string& prefix);

}  // namespace rfmvo
