// The reader's clock against the device's, from when reports arrive. A report arrives after what it stamps, by a
// delay that is never negative and often near its least: so arrival less stamp, over time, has a straight lower
// edge, and that edge is the offset and its drift. What cannot be seen is the least delay itself (some ms of
// reader and network); the estimator carries it as its time offset.
//
// The one place where times of the two clocks meet; pure.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "base/time.hpp"

namespace rfmvo {

class ReaderClockFilter {
 public:
  static constexpr double kMaxDrift = 200e-6;  // s/s; crystals are within 100 ppm, on both sides

  // What was stamped `stamp` has arrived. If the reader's clock has been set since: by how much it went forward
  // (negative: back); from then on the new clock counts.
  std::optional<Duration> observe(ReaderTime stamp, DeviceTime arrival);
  // A new connection: the reader may have been restarted, so the next stamp decides whether its clock is the same.
  void suspect() { suspect_ = true; }
  // Another clock altogether (the reader's uptime instead of its UTC).
  void forget();

  [[nodiscard]] bool known() const { return !buckets_.empty(); }
  // Only if known().
  [[nodiscard]] DeviceTime to_device(ReaderTime stamp) const;
  [[nodiscard]] double drift() const { return slope_; }  // of device less reader clock, s/s
  // Device less reader clock at the newest second, only if known(); resolves 0.1 us, however many years it is.
  [[nodiscard]] double offset_s() const;
  // 1 sigma of to_device(), from how far the least delays of single seconds lie from the edge.
  [[nodiscard]] Duration sigma() const { return sigma_; }

 private:
  struct Point {
    ReaderTime stamp;
    std::int64_t delay_ns;  // arrival less stamp: offset plus delay
  };
  struct Late {  // stamps that arrive as if the clock had been set back
    Point least;
    ReaderTime first;
    DeviceTime since;
    int count = 0;
  };

  [[nodiscard]] double line_ns(ReaderTime stamp) const;  // of the edge, from its reference
  [[nodiscard]] double excess_ns(const Point& point) const;
  std::optional<Duration> stepped(const Point& point, DeviceTime arrival);
  Duration restart(const Point& point);
  void add(const Point& point);
  void fit();

  std::deque<Point> buckets_;  // the least delay of each second of the reader's clock, oldest first
  Point reference_{};
  double slope_ = 0.0;
  double intercept_ns_ = 0.0;  // of the edge at the reference
  Duration sigma_{};
  std::optional<Late> late_;
  bool suspect_ = false;
};

}  // namespace rfmvo
