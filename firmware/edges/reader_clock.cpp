#include "edges/reader_clock.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/assert.hpp"

namespace rfmvo {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::size_t kMaxBuckets = 120;        // two minutes: 200 us of jitter then leave 3 ppm of drift
constexpr double kMinSpanForDrift_s = 20.0;     // before that, drift is below the jitter
constexpr std::size_t kMinBucketsForSigma = 3;  // and for a step
constexpr Duration kFirstSigma{5'000'000};      // one delay says little; a quiet network has some ms
constexpr double kEarly_ns = 20e6;              // no delay is negative: earlier than this, the clock was set forward
constexpr double kLate_ns = 50e6;               // later than this for kLateFor with no exception: it was set back
constexpr Duration kLateFor{2 * kNsPerSecond};
constexpr int kLateCount = 5;
constexpr double kTooLate_ns = 10e9;  // no report is on its way for longer than the watchdog lives

}  // namespace

double ReaderClockFilter::line_ns(ReaderTime stamp) const {
  return intercept_ns_ + slope_ * static_cast<double>((stamp - reference_.stamp).ns);
}

DeviceTime ReaderClockFilter::to_device(ReaderTime stamp) const {
  RFMVO_ASSERT(known());
  return {stamp.ns + reference_.delay_ns + std::llround(line_ns(stamp))};
}

double ReaderClockFilter::offset_s() const {
  RFMVO_ASSERT(known());
  return static_cast<double>(reference_.delay_ns) * 1e-9 + line_ns(buckets_.back().stamp) * 1e-9;
}

void ReaderClockFilter::forget() {
  buckets_.clear();
  late_.reset();
  suspect_ = false;
  slope_ = intercept_ns_ = 0.0;
  sigma_ = kFirstSigma;
}

// How much later than on the edge it arrived. The edge is taken where the old clock would have been: the new
// stamp may be decades away. Differences in integers first, doubles count hundreds of ns there.
double ReaderClockFilter::excess_ns(const Point& point) const {
  const ReaderTime expected{point.stamp.ns + point.delay_ns - reference_.delay_ns};
  return static_cast<double>(point.delay_ns - reference_.delay_ns) - line_ns(expected);
}

Duration ReaderClockFilter::restart(const Point& point) {
  const std::int64_t step_ns = -std::llround(excess_ns(point));
  forget();
  reference_ = point;
  add(point);
  return {step_ns};
}

std::optional<Duration> ReaderClockFilter::observe(ReaderTime stamp, DeviceTime arrival) {
  const Point point{stamp, arrival.ns - stamp.ns};
  if (!known()) {
    forget();
    reference_ = point;
    add(point);
    return std::nullopt;
  }
  if (const auto step = stepped(point, arrival)) return step;
  if (!late_) add(point);
  return std::nullopt;
}

std::optional<Duration> ReaderClockFilter::stepped(const Point& point, DeviceTime arrival) {
  const double late_ns = excess_ns(point);
  const bool suspect = std::exchange(suspect_, false);
  if (late_ns < -kEarly_ns || late_ns > kTooLate_ns || (suspect && late_ns > kLate_ns)) {
    // As long as a few seconds are all that is known, all of them may have been held up: the edge was only guessed.
    const bool guessed = buckets_.size() < kMinBucketsForSigma && std::abs(late_ns) < kTooLate_ns && !suspect;
    const Duration step = restart(point);
    return guessed ? std::nullopt : std::optional(step);
  }
  if (late_ns <= kLate_ns) {
    late_.reset();
    return std::nullopt;
  }
  if (!late_) late_ = Late{point, point.stamp, arrival, 0};
  if (point.delay_ns < late_->least.delay_ns) late_->least = point;
  // By both clocks: a stall of the network delivers two seconds of stamps in one moment, and the reverse.
  const Duration lasted = std::min(point.stamp - late_->first, arrival - late_->since);
  if (++late_->count < kLateCount || lasted < kLateFor) return std::nullopt;
  return restart(Point{late_->least});
}

void ReaderClockFilter::add(const Point& point) {
  const auto second = [](const Point& p) { return p.stamp.ns / kNsPerSecond; };
  if (buckets_.empty() || second(point) > second(buckets_.back())) {
    buckets_.push_back(point);
    if (buckets_.size() > kMaxBuckets) buckets_.pop_front();
    fit();
  } else if (point.delay_ns < buckets_.back().delay_ns) {
    buckets_.back() = point;
    fit();
  }
}

// The line below all points with the least sum of distances: the edge of the lower convex hull over the points'
// mean time. (Moon, Skelly, Towsley: Estimation and removal of clock skew, INFOCOM 1999.)
void ReaderClockFilter::fit() {
  struct Xy {
    double x_ns, y_ns;
  };
  std::vector<Xy> points, hull;
  double mean_ns = 0.0, least_ns = HUGE_VAL;
  for (const Point& p : buckets_) {
    points.push_back(
        {static_cast<double>((p.stamp - reference_.stamp).ns), static_cast<double>(p.delay_ns - reference_.delay_ns)});
    mean_ns += points.back().x_ns / static_cast<double>(buckets_.size());
    least_ns = std::min(least_ns, points.back().y_ns);
  }
  for (const Xy& p : points) {
    const auto above = [&](const Xy& a, const Xy& b) {
      return (b.x_ns - a.x_ns) * (p.y_ns - a.y_ns) <= (p.x_ns - a.x_ns) * (b.y_ns - a.y_ns);
    };
    while (hull.size() >= 2 && above(hull[hull.size() - 2], hull.back())) hull.pop_back();
    hull.push_back(p);
  }
  slope_ = 0.0;
  intercept_ns_ = least_ns;
  if (points.back().x_ns - points.front().x_ns > kMinSpanForDrift_s * kNsPerSecond) {
    std::size_t right = 1;
    while (right + 1 < hull.size() && hull[right].x_ns < mean_ns) ++right;
    const Xy &a = hull[right - 1], &b = hull[right];
    const double slope = (b.y_ns - a.y_ns) / (b.x_ns - a.x_ns);
    if (std::abs(slope) <= kMaxDrift) {
      slope_ = slope;
      intercept_ns_ = a.y_ns - slope * a.x_ns;
    }
  }
  // The newest second has only begun.
  if (points.size() < kMinBucketsForSigma) return;
  points.pop_back();
  double squares = 0.0;
  for (const Xy& p : points) squares += std::pow(p.y_ns - intercept_ns_ - slope_ * p.x_ns, 2);
  sigma_ = {std::llround(std::sqrt(squares / static_cast<double>(points.size())))};
}

}  // namespace rfmvo
