#include "daemon/shutdown_guard.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>

#include "edges/stop_signal.hpp"

namespace rfmvo {
namespace {

constexpr std::chrono::milliseconds kLook{50}, kForTheLoop{1300};
constexpr Duration kForTheJournal{400'000'000};

}  // namespace

ShutdownGuard::ShutdownGuard(JournalRecorder* journal) : journal_(journal), thread_([this] { watch(); }) {}

ShutdownGuard::~ShutdownGuard() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ShutdownGuard::watch() {
  std::unique_lock lock(mutex_);
  while (!over_ && !stop_requested()) changed_.wait_for(lock, kLook);
  if (changed_.wait_for(lock, kForTheLoop, [this] { return over_; })) return;
  spdlog::warn("the last solution was not ready in time and is not published");
  if (journal_ != nullptr && !journal_->close_within(kForTheJournal))
    spdlog::warn("the disk is too slow: the journal ends where it is, and is put in order at the next start");
  ::_exit(0);
}

}  // namespace rfmvo
