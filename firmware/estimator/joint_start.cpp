#include "estimator/joint_start.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "base/units.hpp"
#include "estimator/joint_solver.hpp"
#include "estimator/port_offset_scan.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

constexpr std::size_t kMinReads = 8;  // of a tag that takes part: four unknowns and some to judge by
constexpr double kSameScale = 0.045;  // two starts this near in ln(scale) are one

struct ScalePower {
  double log_scale = 0.0;
  double power = 0.0;
};

SpectrumOptions spectrum_options(const std::vector<SpectrumRead>& reads, double finest_m, const StartOptions& o,
                                 int peaks) {
  constexpr double kWidest_m = 0.3;
  return {.cell_m = suitable_cell(reads, finest_m, kWidest_m), .range_max_m = o.range_max_m, .max_peaks = peaks};
}

// Tags with most reads first.
std::vector<std::size_t> busiest_tags(const JointProblem& problem, std::size_t count) {
  std::vector<std::size_t> order(problem.reads.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t t) { return problem.reads[t].size() < kMinReads; });
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return problem.reads[a].size() > problem.reads[b].size(); });
  if (order.size() > count) order.resize(count);
  return order;
}

double power_of(const JointProblem& problem, const JointState& state, const std::vector<std::size_t>& tags,
                const BeamModel& beams, const StartOptions& o) {
  double power = 0.0;
  for (const std::size_t t : tags) {
    const std::vector<SpectrumRead> reads = spectrum_reads(problem.reads[t], state, beams, false, o.max_reads);
    const auto peaks = search_near_field(reads, spectrum_options(reads, o.coarse_cell_m, o, 1));
    // The best of many cells is high in noise too: ln(cells), since a cell's power is exponential.
    if (!peaks.empty()) power += peaks[0].power - std::log(std::max(1.0, peaks[0].cells));
  }
  return power;
}

// Scales in falling order of power, each a local best of its neighbourhood.
std::vector<ScalePower> best_scales(const JointProblem& problem, JointState state, const std::vector<std::size_t>& tags,
                                    const BeamModel& beams, const StartOptions& o) {
  const std::vector<std::size_t> first(tags.begin(),
                                       tags.begin() + static_cast<std::ptrdiff_t>(std::min(o.first_tags, tags.size())));
  const std::vector<std::size_t> rest(tags.begin() + static_cast<std::ptrdiff_t>(first.size()), tags.end());
  std::vector<ScalePower> scales;
  for (double s = o.log_scale_min; s <= o.log_scale_max; s += o.log_scale_step) {
    state.log_scale = s;
    scales.push_back({s, power_of(problem, state, first, beams, o)});
  }
  const auto stronger = [](const ScalePower& a, const ScalePower& b) { return a.power > b.power; };
  std::stable_sort(scales.begin(), scales.end(), stronger);
  if (!rest.empty()) {
    scales.resize(std::min<std::size_t>(scales.size(), 16));
    for (ScalePower& s : scales) {
      state.log_scale = s.log_scale;
      s.power += power_of(problem, state, rest, beams, o);
    }
    std::stable_sort(scales.begin(), scales.end(), stronger);
  }
  std::vector<ScalePower> kept;
  for (const ScalePower& s : scales) {
    if (kept.size() >= o.scales) break;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const ScalePower& k) {
      return std::abs(k.log_scale - s.log_scale) < kSameScale;
    });
    if (!known) kept.push_back(s);
  }
  return kept;
}

// Where each tag may be, whatever the ports' offsets are.
std::vector<PossiblePlaces> places_of(const JointProblem& problem, const JointState& state, const BeamModel& beams,
                                      const StartOptions& o) {
  std::vector<PossiblePlaces> places;
  for (const std::vector<JointRead>& reads : problem.reads)
    places.push_back(search_places(reads, state, beams, {.range_max_m = o.range_max_m, .max_reads = o.max_reads}));
  return places;
}

// Each tag at its best mode, all ports together.
void place_tags(const JointProblem& problem, const BeamModel& beams, const std::vector<PossiblePlaces>& places,
                JointState& state) {
  constexpr std::size_t kModes = 8;
  for (std::size_t t = 0; t < problem.reads.size(); ++t) {
    const auto modes = find_modes(problem, t, state, beams, places[t].at(state.log_scale), kModes);
    if (!modes.empty()) state.tags[t] = modes[0].tag;
  }
}

struct Rough {
  JointState state;
  std::shared_ptr<const std::vector<PossiblePlaces>> places;  // of its step of the scale grid
  double reference_scale_m = 1.0;
  double cost = 0.0;
};

// A scale and port offsets at which many tags' reads agree.
struct Agreement {
  double log_scale = 0.0;
  PortOffsets offsets;
};

void adopt(const JointProblem& problem, const std::vector<PossiblePlaces>& places, const Agreement& agreement,
           JointState& state) {
  const std::vector<double>& offset_rad = agreement.offsets.offset_rad;
  state.log_scale = agreement.log_scale;
  for (std::size_t p = 0; p < state.ports.size(); ++p) state.ports[p].offset_rad = offset_rad[p];
  for (std::size_t t = 0; t < places.size(); ++t) {
    if (places[t].p_W_X.empty()) continue;
    const TagPlaces tag = phasors_at(problem.reads[t], state, places[t].at(agreement.log_scale));
    const std::size_t k = best_place(tag, offset_rad);
    std::complex<double> sum;
    for (std::size_t p = 0; p < offset_rad.size(); ++p) sum += tag.phasor[k][p] * std::polar(1.0, -offset_rad[p]);
    state.tags[t].p_W_X = tag.p_W_X[k];
    state.tags[t].offset_rad = std::arg(sum);
  }
}

// The best agreements about one scale of the grid. The grid is too wide for the ports to agree between
// its steps: places found at a step are carried to finer ones, as all lengths grow with the scale.
std::vector<Agreement> agreements_about(const JointProblem& problem, JointState state,
                                        const std::vector<PossiblePlaces>& places, const StartOptions& o) {
  const double middle = state.log_scale;
  constexpr int kFiner = 3;
  std::vector<Agreement> found;
  for (int step = -kFiner; step <= kFiner; ++step) {
    state.log_scale = middle + 0.5 * o.log_scale_step * step / kFiner;
    std::vector<TagPlaces> tags;
    for (std::size_t t = 0; t < places.size(); ++t)
      tags.push_back(phasors_at(problem.reads[t], state, places[t].at(state.log_scale)));
    for (PortOffsets& offsets : scan_port_offsets(tags, state.ports.size(), o.offsets_per_scale))
      found.push_back({state.log_scale, std::move(offsets)});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Agreement& a, const Agreement& b) { return a.offsets.power > b.offsets.power; });
  if (found.size() > o.offsets_per_scale) found.resize(o.offsets_per_scale);
  return found;
}

bool same_start(const JointState& a, const JointState& b) {
  constexpr double kScale = 0.008, kOffset_rad = 0.7;
  bool same = std::abs(a.log_scale - b.log_scale) < kScale;
  for (std::size_t p = 0; p < a.ports.size(); ++p)
    same = same && std::abs(wrap_rad(a.ports[p].offset_rad - b.ports[p].offset_rad)) < kOffset_rad;
  return same;
}

// The best agreements of one scale, each with its tags, path bent a little.
std::vector<Rough> rough_starts(JointProblem problem, const JointState& blank, double log_scale, const BeamModel& beams,
                                const StartOptions& o) {
  problem.reference_scale_m = std::exp(log_scale);
  JointState state = blank;
  state.log_scale = log_scale;
  const auto places = std::make_shared<const std::vector<PossiblePlaces>>(places_of(problem, state, beams, o));
  std::vector<Rough> found;
  for (const Agreement& agreement : agreements_about(problem, state, *places, o)) {
    Rough r{state, places, problem.reference_scale_m, 0.0};
    adopt(problem, *places, agreement, r.state);
    r.cost = solve(problem, {.max_iterations = 5}, r.state).cost;
    found.push_back(std::move(r));
  }
  return found;
}

StartCandidate refine(JointProblem problem, Rough rough, const BeamModel& beams) {
  problem.reference_scale_m = rough.reference_scale_m;
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    JointState again = rough.state;
    place_tags(problem, beams, *rough.places, again);
    const double cost = solve(problem, {.max_iterations = 10}, again).cost;
    if (cost >= rough.cost) break;
    rough.cost = cost;
    rough.state = again;
  }
  StartCandidate c;
  c.evidence = evidence(problem, rough.state);
  c.state = std::move(rough.state);
  return c;
}

}  // namespace

std::vector<StartCandidate> find_starts(const JointProblem& problem, const JointState& state, const BeamModel& beams,
                                        const StartOptions& options) {
  const std::vector<std::size_t> used = busiest_tags(problem, options.all_tags);
  if (used.empty()) return {};
  JointProblem part = problem;
  JointState blank = state;
  part.reads.clear();
  blank.tags.clear();
  for (const std::size_t t : used) {
    part.reads.push_back(problem.reads[t]);
    blank.tags.push_back(state.tags[t]);
  }
  std::vector<std::size_t> all(used.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<Rough> rough;
  for (const ScalePower& s : best_scales(part, blank, all, beams, options))
    for (Rough& r : rough_starts(part, blank, s.log_scale, beams, options)) rough.push_back(std::move(r));
  std::stable_sort(rough.begin(), rough.end(), [](const Rough& a, const Rough& b) { return a.cost < b.cost; });
  // Neighbouring steps of the grid lead to the same place.
  std::vector<Rough> distinct;
  for (Rough& r : rough) {
    const bool known =
        std::any_of(distinct.begin(), distinct.end(), [&](const Rough& d) { return same_start(d.state, r.state); });
    if (!known && distinct.size() < options.candidates) distinct.push_back(std::move(r));
  }
  std::vector<StartCandidate> found;
  for (Rough& r : distinct) {
    const StartCandidate c = refine(part, r, beams);
    JointState whole = state;
    whole.log_scale = c.state.log_scale;
    whole.time_offset_s = c.state.time_offset_s;
    whole.ports = c.state.ports;
    whole.knots = c.state.knots;
    for (std::size_t i = 0; i < used.size(); ++i) whole.tags[used[i]] = c.state.tags[i];
    found.push_back({std::move(whole), used, *r.places, c.evidence});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const StartCandidate& a, const StartCandidate& b) { return a.evidence > b.evidence; });
  return found;
}

}  // namespace rfmvo
