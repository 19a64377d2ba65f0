// Camera and reader as one stream: begins with the Start, ends after the camera, loses nothing in between.
#include "edges/live_source.hpp"

#include <gtest/gtest.h>

namespace rfmvo {
namespace {

// A camera of `frames` frames, as fast as they are taken.
class ListCamera : public EventSource {
 public:
  explicit ListCamera(int frames, std::optional<Error> error = std::nullopt)
      : frames_(frames), error_(std::move(error)) {}
  [[nodiscard]] Result<std::optional<Event>> next() override {
    if (next_ == 0) {
      ++next_;
      return std::optional<Event>(Start{});
    }
    if (next_ > frames_ && error_) return *error_;
    if (next_ > frames_) return std::optional<Event>();
    Frame frame;
    frame.sequence = next_++;
    return std::optional<Event>(std::move(frame));
  }

 private:
  int frames_;
  int next_ = 0;
  std::optional<Error> error_;
};

// A reader that has a read at every poll, ahead of the camera's Start too, until it has had its fill.
class EagerReader : public Reader {
 public:
  EagerReader(DeviceClockFunction clock, std::atomic<bool>& stopped) : clock_(std::move(clock)), stopped_(stopped) {}
  [[nodiscard]] std::vector<Event> poll(Duration) override {
    std::this_thread::yield();
    if (count_ == kReads) return {};
    TagRead read;
    read.time = clock_();
    read.reader_time = ReaderTime{count_++};
    return {read};
  }
  void wake() override {}
  void stop() override { stopped_ = true; }

 private:
  static constexpr std::int64_t kReads = 500;
  DeviceClockFunction clock_;
  std::atomic<bool>& stopped_;
  std::int64_t count_ = 0;
};

// All at once more reads than may wait, then one at every poll.
class FloodingReader : public Reader {
 public:
  explicit FloodingReader(DeviceClockFunction clock) : clock_(std::move(clock)) {}
  [[nodiscard]] std::vector<Event> poll(Duration) override {
    std::this_thread::yield();
    std::vector<Event> events(next_ == 0 ? 100'500 : 1);
    for (Event& event : events) {
      TagRead read;
      read.time = clock_();
      read.reader_time = ReaderTime{next_++};
      event = read;
    }
    return events;
  }
  void wake() override {}
  void stop() override {}

 private:
  DeviceClockFunction clock_;
  std::int64_t next_ = 0;
};

struct Stream {
  std::vector<Event> events;
  std::string error;
};

Stream read_all(EventSource& source) {
  Stream stream;
  while (true) {
    auto next = source.next();
    if (!next) stream.error = next.error().text();
    if (!next || !next.value()) return stream;
    stream.events.push_back(*std::move(next).value());
  }
}

LiveSource::MakeCamera camera_of(int frames, std::optional<Error> error = std::nullopt) {
  return [=](const std::atomic<bool>&) { return std::make_unique<ListCamera>(frames, error); };
}

TEST(LiveSource, BeginsWithTheStartAndLosesNothing) {
  constexpr int kFrames = 300;  // more than may wait
  std::atomic<bool> stopped{false};
  {
    LiveSource source(camera_of(kFrames), std::make_unique<EagerReader>(device_clock(), stopped), device_clock());
    const Stream stream = read_all(source);
    EXPECT_EQ(stream.error, "");
    ASSERT_FALSE(stream.events.empty());
    EXPECT_TRUE(std::holds_alternative<Start>(stream.events.front()));
    std::int64_t frames = 0, reads = 0;
    for (const Event& event : stream.events) {
      if (const auto* frame = std::get_if<Frame>(&event)) {
        EXPECT_EQ(frame->sequence, ++frames);
      } else if (const auto* read = std::get_if<TagRead>(&event)) {
        EXPECT_EQ(read->reader_time.ns, reads++);
      }
    }
    EXPECT_EQ(frames, kFrames);
    EXPECT_GT(reads, 0);
  }
  EXPECT_TRUE(stopped) << "the reader was left in order";
}

TEST(LiveSource, CountsWhatItMustDrop) {
  LiveSource source(camera_of(1'000'000'000), std::make_unique<FloodingReader>(device_clock()), device_clock());
  std::int64_t expected = 0, missing = 0;
  while (missing == 0) {
    const auto next = source.next();
    ASSERT_TRUE(next.ok() && next.value());
    const auto* read = std::get_if<TagRead>(&*next.value());
    if (read == nullptr) continue;
    missing = read->reader_time.ns - expected;
    expected = read->reader_time.ns + 1;
  }
  EXPECT_GE(missing, 500);
  EXPECT_GE(source.counters().reads_dropped, static_cast<std::uint64_t>(missing));
}

TEST(LiveSource, EndsWithTheCamerasError) {
  LiveSource source(camera_of(2, Error{ErrorCode::kUnreadable, "gone", "camera"}), nullptr, device_clock());
  const Stream stream = read_all(source);
  EXPECT_EQ(stream.error, "camera: gone");
  EXPECT_EQ(stream.events.size(), 3u) << "what came before is not lost";
}

TEST(LiveSource, CanBeLeftAtAnyMoment) {
  std::atomic<bool> stopped{false};
  for (int taken = 0; taken < 4; ++taken) {
    LiveSource source(camera_of(1000), std::make_unique<EagerReader>(device_clock(), stopped), device_clock());
    for (int k = 0; k < taken; ++k) ASSERT_TRUE(source.next().ok());
  }
  EXPECT_TRUE(stopped);
}

}  // namespace
}  // namespace rfmvo
