// The journal of a box: a thread of its own writes, so that a card that stalls, fills up or breaks stops nothing else.
// What could not be written is counted, and said in the journal itself (JOURNAL_GAP) where it is missing.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "edges/event_io.hpp"
#include "edges/recorder/journal_queue.hpp"
#include "edges/recorder/journal_store.hpp"

namespace rfmvo {

class JournalRecorder : public EventSink {
 public:
  struct Settings {
    std::string prefix;
    std::int64_t queue_bytes = 0;
    Duration flush;        // at most so long until what was written outlives a power failure
    bool may_drop = true;  // false: write() waits for room instead. For sources that can wait, such as files
  };
  struct Counters {
    JournalLoss lost;
    std::int64_t bytes_written = 0, queue_bytes = 0;
    std::string last_error;  // of the disk
  };

  JournalRecorder(std::unique_ptr<JournalStore> store, Settings settings);
  ~JournalRecorder() override;  // as close()

  // No error of the disk comes out here: counters() tells.
  [[nodiscard]] Status write(const Event& event) override;
  // Everything that waits is written. The error, if the disk's last word was one.
  [[nodiscard]] Status close();
  // The same from another thread, for a program that must go; false: not everything is written yet.
  [[nodiscard]] bool close_within(Duration limit);
  [[nodiscard]] Counters counters() const;

 private:
  void run();
  void write_item(const JournalItem& item);
  void write_loss(std::int64_t utime);
  [[nodiscard]] Status append(const std::string& channel, std::int64_t utime, std::span<const std::uint8_t> data);
  void note(const Status& status);

  std::unique_ptr<JournalStore> store_;
  Settings settings_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  JournalQueue queue_;
  bool closing_ = false, closed_ = false;
  Counters counters_;

  // The writing thread's own.
  std::int64_t record_number_ = 0;
  JournalLoss unsaid_;  // lost, but not said in the journal yet
  bool started_ = false;
  std::int64_t last_utime_ = 0;

  std::thread thread_;
};

}  // namespace rfmvo
