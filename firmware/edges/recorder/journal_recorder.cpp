#include "edges/recorder/journal_recorder.hpp"

#include <chrono>
#include <optional>

#include "edges/lcm_codec.hpp"
#include "edges/log_file.hpp"
#include "rfmvo/journal_gap_t.hpp"

namespace rfmvo {
namespace {

using SteadyClock = std::chrono::steady_clock;

}  // namespace

JournalRecorder::JournalRecorder(std::unique_ptr<JournalStore> store, Settings settings)
    : store_(std::move(store)), settings_(std::move(settings)), queue_(settings_.queue_bytes) {
  thread_ = std::thread([this] { run(); });
}

JournalRecorder::~JournalRecorder() { (void)close(); }

Status JournalRecorder::write(const Event& event) {
  std::unique_lock lock(mutex_);
  if (closing_) {
    // Only a program that has run out of time goes on while its journal closes.
    (std::holds_alternative<Frame>(event) ? counters_.lost.frames : counters_.lost.others) += 1;
    return Done{};
  }
  if (!settings_.may_drop) changed_.wait(lock, [&] { return queue_.has_room(event); });
  queue_.push(event);
  changed_.notify_all();
  return Done{};
}

Status JournalRecorder::close() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(mutex_);
  if (counters_.last_error.empty()) return Done{};
  return Error{ErrorCode::kUnwritable, counters_.last_error, ""};
}

bool JournalRecorder::close_within(Duration limit) {
  std::unique_lock lock(mutex_);
  closing_ = true;
  changed_.notify_all();
  return changed_.wait_for(lock, std::chrono::nanoseconds(limit.ns), [this] { return closed_; });
}

JournalRecorder::Counters JournalRecorder::counters() const {
  const std::lock_guard lock(mutex_);
  Counters counters = counters_;
  counters.lost += queue_.lost();
  counters.queue_bytes = queue_.bytes();
  return counters;
}

void JournalRecorder::run() {
  const std::chrono::nanoseconds flush(settings_.flush.ns);
  bool unsynced = false;
  SteadyClock::time_point unsynced_since{};
  while (true) {
    std::optional<JournalItem> item;
    {
      std::unique_lock lock(mutex_);
      const auto ready = [this] { return closing_ || !queue_.empty(); };
      if (unsynced)
        changed_.wait_until(lock, unsynced_since + flush, ready);
      else
        changed_.wait(lock, ready);
      item = queue_.pop();
      if (!item && closing_) {
        unsaid_ += queue_.take_tail_loss();
        break;
      }
    }
    changed_.notify_all();  // there is room
    if (item) {
      write_item(*item);
      if (!unsynced) unsynced_since = SteadyClock::now();
      unsynced = true;
    }
    if (unsynced && SteadyClock::now() >= unsynced_since + flush) {
      note(store_->sync());
      unsynced = false;
    }
  }
  write_loss(last_utime_);
  note(store_->close());
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void JournalRecorder::write_item(const JournalItem& item) {
  unsaid_ += item.lost_before;
  const LcmMessage message = encode(item.event, settings_.prefix);
  last_utime_ = message.utime;
  if (started_) write_loss(message.utime);
  Status written = Done{};
  if (std::holds_alternative<Start>(item.event)) {
    std::vector<std::uint8_t> record;
    append_log_record(record, record_number_++, message.utime, message.channel, message.data);
    written = store_->begin(std::move(record));
    note(written);
    started_ = true;
  } else {
    written = append(message.channel, message.utime, message.data);
  }
  if (written) return;
  JournalLoss loss;
  (std::holds_alternative<Frame>(item.event) ? loss.frames : loss.others) = 1;
  unsaid_ += loss;
  const std::lock_guard lock(mutex_);
  counters_.lost += loss;
}

void JournalRecorder::write_loss(std::int64_t utime) {
  if (!unsaid_.any()) return;
  journal_gap_t gap;
  gap.utime = utime;
  gap.frames = static_cast<std::int64_t>(unsaid_.frames);
  gap.others = static_cast<std::int64_t>(unsaid_.others);
  std::vector<std::uint8_t> data(static_cast<std::size_t>(gap.getEncodedSize()));
  (void)gap.encode(data.data(), 0, static_cast<int>(data.size()));
  if (append(settings_.prefix + "JOURNAL_GAP", utime, data)) unsaid_ = {};
}

Status JournalRecorder::append(const std::string& channel, std::int64_t utime, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> record;
  append_log_record(record, record_number_, utime, channel, data);
  const Status appended = store_->append(record);
  if (appended) ++record_number_;
  note(appended);
  if (appended) {
    const std::lock_guard lock(mutex_);
    counters_.bytes_written += static_cast<std::int64_t>(record.size());
  }
  return appended;
}

void JournalRecorder::note(const Status& status) {
  const std::lock_guard lock(mutex_);
  counters_.last_error = status ? "" : status.error().text();
}

}  // namespace rfmvo
