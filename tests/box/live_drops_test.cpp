// A camera that does not wait for the estimator: the oldest frames go, reads do not, and everything is counted.
#include <gtest/gtest.h>

#include <thread>

#include "edges/live_source.hpp"

namespace rfmvo {
namespace {

// Frames as fast as they are taken; at the end it waits to be told to stop, as a camera would.
class EagerCamera : public EventSource {
 public:
  EagerCamera(std::int64_t frames, std::atomic<bool>& finished, const std::atomic<bool>& stop)
      : frames_(frames), finished_(finished), stop_(stop) {}
  [[nodiscard]] Result<std::optional<Event>> next() override {
    if (next_ == 0) {
      ++next_;
      return std::optional<Event>(Start{});
    }
    if (next_ > frames_) {
      finished_ = true;
      while (!stop_) std::this_thread::yield();
      return std::optional<Event>();
    }
    Frame frame;
    frame.sequence = next_++;
    return std::optional<Event>(std::move(frame));
  }

 private:
  std::int64_t frames_, next_ = 0;
  std::atomic<bool>& finished_;
  const std::atomic<bool>& stop_;
};

class SomeReads : public Reader {
 public:
  [[nodiscard]] std::vector<Event> poll(Duration) override {
    std::this_thread::yield();
    if (count_ == kReads) return {};
    TagRead read;
    read.reader_time = ReaderTime{count_++};
    return {read};
  }
  void wake() override {}
  void stop() override {}
  static constexpr std::int64_t kReads = 300;

 private:
  std::int64_t count_ = 0;
};

TEST(LiveDrops, TheOldestFramesGoReadsStayAndTheStreamSaysSo) {
  constexpr std::int64_t kFrames = 500;
  std::atomic<bool> finished{false}, leave{false};
  LiveSource source(
      [&](const std::atomic<bool>& stop) { return std::make_unique<EagerCamera>(kFrames, finished, stop); },
      std::make_unique<SomeReads>(), device_clock(), {WhenFull::kDropOldestFrame, [&] { return leave.load(); }});
  // Nobody takes anything until the camera has given all it has.
  while (!finished || source.counters().events_waiting < static_cast<std::size_t>(SomeReads::kReads)) {
    std::this_thread::yield();
  }
  source.post(Command{DeviceTime{}, "key", "value"});
  const LiveCounters before = source.counters();
  EXPECT_EQ(before.frames_waiting + before.frames_dropped, static_cast<std::size_t>(kFrames));
  EXPECT_GT(before.frames_dropped, 0u);
  std::int64_t last_frame = static_cast<std::int64_t>(before.frames_dropped), reads = 0, faults = 0, commands = 0;
  for (auto next = source.next(); next.ok() && next.value(); next = source.next()) {
    if (const auto* frame = std::get_if<Frame>(&*next.value())) {
      EXPECT_EQ(frame->sequence, ++last_frame) << "the newest frames are left, in order";
    }
    reads += std::holds_alternative<TagRead>(*next.value()) ? 1 : 0;
    faults += std::holds_alternative<Fault>(*next.value()) ? 1 : 0;
    commands += std::holds_alternative<Command>(*next.value()) ? 1 : 0;
    if (reads == SomeReads::kReads) leave = true;  // what has arrived is still worked off
  }
  EXPECT_EQ(last_frame, kFrames);
  EXPECT_EQ(reads, SomeReads::kReads);
  EXPECT_EQ(commands, 1);
  EXPECT_EQ(faults, 1);
}

TEST(LiveDrops, StoppingWorksOffWhatHasArrived) {
  std::atomic<bool> finished{false}, leave{false};
  LiveSource source([&](const std::atomic<bool>& stop) { return std::make_unique<EagerCamera>(40, finished, stop); },
                    nullptr, device_clock(), {WhenFull::kDropOldestFrame, [&] { return leave.load(); }});
  while (!finished) std::this_thread::yield();
  leave = true;
  std::int64_t frames = 0;
  for (auto next = source.next(); next.ok() && next.value(); next = source.next())
    frames += std::holds_alternative<Frame>(*next.value()) ? 1 : 0;
  EXPECT_EQ(frames, 40);
}

}  // namespace
}  // namespace rfmvo
