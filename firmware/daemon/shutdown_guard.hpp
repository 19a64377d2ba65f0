// A stop within two seconds, whatever the estimator is busy with: if the loop has not ended in time, the journal is
// closed and the program ends without its last solution.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "edges/recorder/journal_recorder.hpp"

namespace rfmvo {

class ShutdownGuard {
 public:
  explicit ShutdownGuard(JournalRecorder* journal);  // may be null
  ~ShutdownGuard();

 private:
  void watch();

  JournalRecorder* journal_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace rfmvo
