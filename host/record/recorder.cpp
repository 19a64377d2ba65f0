#include "record/recorder.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

namespace rfmvo::record {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxQueueBytes = std::size_t{256} << 20;
constexpr Duration kListen{Duration::from_seconds(0.05)};
// After the stop: what has arrived is taken, for at most so long; others may go on talking.
constexpr std::chrono::seconds kDrain{1};

std::int64_t realtime_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

struct Received {
  BusMessage message;
  std::int64_t utime = 0;
  BusLoss loss;  // until now
};

// Listens in a thread of its own. Full: waits, and the bus counts what the machine then drops.
class Inbox {
 public:
  explicit Inbox(BusListener& bus) : bus_(bus), thread_([this] { listen(); }) {}
  ~Inbox() {
    {
      const std::lock_guard lock(mutex_);
      abandoned_ = true;
    }
    room_.notify_all();
    finish();
    thread_.join();
  }
  Inbox(const Inbox&) = delete;
  Inbox& operator=(const Inbox&) = delete;

  void finish() { stopping_ = true; }
  // Waits a little. Nothing: nothing came, or, if done(), nothing will.
  std::optional<Received> take() {
    std::unique_lock lock(mutex_);
    filled_.wait_for(lock, std::chrono::nanoseconds(kListen.ns), [this] { return !queue_.empty() || done_; });
    if (queue_.empty()) return std::nullopt;
    Received received = std::move(queue_.front());
    queue_.pop_front();
    bytes_ -= received.message.data.size();
    room_.notify_one();
    return received;
  }
  [[nodiscard]] bool done() {
    const std::lock_guard lock(mutex_);
    return done_ && queue_.empty();
  }
  [[nodiscard]] std::optional<Error> error() {
    const std::lock_guard lock(mutex_);
    return error_;
  }
  [[nodiscard]] BusLoss loss() {
    const std::lock_guard lock(mutex_);
    return loss_;
  }

 private:
  void listen() {
    std::optional<Clock::time_point> until;
    while (!until || Clock::now() < *until) {
      if (stopping_ && !until) until = Clock::now() + kDrain;
      auto next = bus_.next(until ? Duration{0} : kListen);
      if (!next) {
        put_end(next.error());
        return;
      }
      if (!next.value() && until) break;
      if (next.value()) put(std::move(*std::move(next).value()));
    }
    put_end(std::nullopt);
  }
  void put(BusMessage message) {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [this] { return bytes_ < kMaxQueueBytes || abandoned_; });
    if (abandoned_) return;
    bytes_ += message.data.size();
    loss_ = bus_.loss();
    queue_.push_back({std::move(message), realtime_us(), loss_});
    filled_.notify_one();
  }
  void put_end(std::optional<Error> error) {
    const std::lock_guard lock(mutex_);
    error_ = std::move(error);
    loss_ = bus_.loss();
    done_ = true;
    filled_.notify_one();
  }

  BusListener& bus_;
  std::atomic<bool> stopping_{false};
  std::mutex mutex_;
  std::condition_variable filled_, room_;
  std::deque<Received> queue_;
  std::size_t bytes_ = 0;
  BusLoss loss_;
  bool done_ = false, abandoned_ = false;
  std::optional<Error> error_;
  std::thread thread_;  // last: it uses all of the above
};

class Writer {
 public:
  Writer(LogSeries& log, const RecorderSettings& settings, RecorderFigures& figures)
      : log_(log), settings_(settings), figures_(figures) {}

  Status write(const Received& received) {
    const BusMessage& message = received.message;
    figures_.loss = received.loss;
    if (const auto sequence = inspect::sequence_of(message.data)) figures_.sequences.add(message.channel, *sequence);
    if (std::regex_match(message.channel, settings_.channels) == settings_.invert) return Done{};
    // What a datagram that was overtaken takes back is not known any more when it is recorded: never below 0.
    const std::uint64_t lost = received.loss.messages > told_lost_ ? received.loss.messages - told_lost_ : 0;
    told_lost_ += lost;
    ++figures_.messages;
    ChannelCount& channel = figures_.channels[message.channel];
    ++channel.messages;
    channel.bytes += message.data.size();
    return log_.write(message, received.utime, lost);
  }

 private:
  LogSeries& log_;
  const RecorderSettings& settings_;
  RecorderFigures& figures_;
  std::uint64_t told_lost_ = 0;
};

}  // namespace

Status record(BusListener& bus, LogSeries& log, const RecorderSettings& settings, const std::function<bool()>& stop,
              const std::function<void(const RecorderFigures&)>& watch, RecorderFigures& figures) {
  Inbox inbox(bus);
  Writer writer(log, settings, figures);
  const auto start = Clock::now();
  auto flushed = start, watched = start;
  while (!inbox.done()) {
    if (const auto received = inbox.take())
      if (Status s = writer.write(*received); !s) return s;
    const auto now = Clock::now();
    figures.length = Duration{(now - start) / std::chrono::nanoseconds(1)};
    if (now - flushed >= std::chrono::nanoseconds(settings.flush_interval.ns)) {
      if (Status s = log.flush(); !s) return s;
      flushed = now;
    }
    if (now - watched >= std::chrono::seconds(1)) {
      watch(figures);
      watched = now;
    }
    if (stop() || (settings.length.ns > 0 && figures.length >= settings.length)) inbox.finish();
  }
  figures.loss = inbox.loss();
  if (const auto error = inbox.error()) return *error;
  return log.close();
}

}  // namespace rfmvo::record
