#include "reproduce/sweeps.hpp"

#include "base/assert.hpp"
#include "evaluate/evaluation.hpp"
#include "reproduce/paper_run.hpp"

namespace rfmvo::reproduce {
namespace {

struct Place {
  std::size_t sweep, point;
  bool repaired;
};

Place place_of(const std::vector<Sweep>& sweeps, std::size_t n) {
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    const std::size_t points = sweeps[s].paper.size();
    if (n < 2 * points) return {s, n / 2, n % 2 == 1};
    n -= 2 * points;
  }
  RFMVO_ASSERT(false);
  return {};
}

void set(PaperConfig& paper, std::size_t sweep, double value) {
  if (sweep == 0) {
    paper.elements = static_cast<std::int64_t>(value);
  } else if (sweep == 1) {
    paper.angle_step_deg = value;
    // "The larger angular granularity requires to set a larger search threshold" (section VII.F): the paper's 20
    // degrees are four steps of 5.
    paper.refine_range_deg = 4.0 * value > paper.refine_range_deg ? 4.0 * value : paper.refine_range_deg;
  } else {
    paper.scale_step = value;
  }
}

struct Values {
  std::vector<double> tag_m, absolute, relative;

  void add(const std::optional<double>& error_m, const std::optional<ScaleError>& scale) {
    if (error_m) tag_m.push_back(*error_m);
    if (!scale) return;
    absolute.push_back(scale->absolute);
    relative.push_back(scale->relative);
  }
  [[nodiscard]] SweepPoint::Side side() const {
    SweepPoint::Side side;
    side.arrays = tag_m.size();
    if (const auto s = evaluate::summarise(tag_m)) {
      side.tag_error_mean_m = s->mean;
      side.tag_error_median_m = s->median;
    }
    if (const auto s = evaluate::summarise(absolute)) side.scale_absolute_mean = s->mean;
    if (const auto s = evaluate::summarise(relative)) {
      side.scale_relative_mean = s->mean;
      side.scale_relative_median = s->median;
    }
    return side;
  }
};

std::vector<SweepPoint> points(std::initializer_list<double> values) {
  std::vector<SweepPoint> points;
  for (const double value : values) points.push_back({.value = value, .arrays_due = 0, .search = {}, .optimized = {}});
  return points;
}

Sweep sweep(const char* parameter, const char* unit, std::initializer_list<double> values) {
  return {parameter, unit, points(values), points(values)};
}

}  // namespace

std::vector<Sweep> empty_sweeps() {
  return {sweep("L", "reads", {20, 30, 40, 50, 60, 70, 80}), sweep("angle_step", "deg", {1, 2, 5, 10}),
          sweep("scale_step", "", {0.05, 0.1, 0.2})};
}

std::size_t sweep_points(const std::vector<Sweep>& sweeps) {
  std::size_t count = 0;
  for (const Sweep& s : sweeps) count += s.paper.size() + s.repaired.size();
  return count;
}

void fill_sweep_point(std::vector<Sweep>& sweeps, std::size_t n, const std::vector<montecarlo::Recording>& recordings,
                      const Config& paper) {
  const Place place = place_of(sweeps, n);
  Sweep& sweep = sweeps[place.sweep];
  SweepPoint& point = (place.repaired ? sweep.repaired : sweep.paper)[place.point];
  Config config = paper;
  if (place.repaired) repair(config.paper);
  set(config.paper, place.sweep, point.value);
  Values search, optimized;
  for (const montecarlo::Recording& recording : recordings) {
    const PaperRun run = run_paper(recording, config);
    point.arrays_due += run.arrays_due;
    for (const ArrayResult& array : run.arrays) {
      search.add(array.search_error_m, array.search_scale_error);
      optimized.add(array.error_m, array.scale_error);
    }
  }
  point.search = search.side();
  point.optimized = optimized.side();
}

}  // namespace rfmvo::reproduce
