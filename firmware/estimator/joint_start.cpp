#include "estimator/joint_start.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/units.hpp"
#include "estimator/joint_solver.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

constexpr std::size_t kMinReads = 8;   // of a tag that takes part: four unknowns and some to judge by
constexpr double kSameScale = 0.045;   // two starts this near in ln(scale) are one

struct ScalePower {
  double log_scale = 0.0;
  double power = 0.0;
};

SpectrumOptions spectrum_options(const std::vector<SpectrumRead>& reads, double finest_m, const StartOptions& o, int peaks) {
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
std::vector<ScalePower> best_scales(const JointProblem& problem, JointState state,
                                    const std::vector<std::size_t>& tags, const BeamModel& beams,
                                    const StartOptions& o) {
  const std::vector<std::size_t> first(tags.begin(), tags.begin() + static_cast<std::ptrdiff_t>(std::min(o.first_tags, tags.size())));
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
    if (kept.size() >= o.candidates) break;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const ScalePower& k) {
      return std::abs(k.log_scale - s.log_scale) < kSameScale;
    });
    if (!known) kept.push_back(s);
  }
  return kept;
}

// Offset of each port against the first, from where the tags are: mean phasor over all reads.
void estimate_port_offsets(const JointProblem& problem, JointState& state) {
  for (PortState& port : state.ports) port.offset_rad = 0.0;
  std::vector<double> c(state.ports.size(), 0.0), s(state.ports.size(), 0.0);
  for (std::size_t t = 0; t < problem.reads.size(); ++t) {
    std::vector<double> tc(state.ports.size(), 0.0), ts(state.ports.size(), 0.0);
    TagState tag = state.tags[t];
    tag.offset_rad = 0.0;
    for (const JointRead& read : problem.reads[t]) {
      const double r = read.phase_rad - predict_phase(read.geometry, states_at(read, state, tag)).phase_rad;
      tc[static_cast<std::size_t>(read.port)] += std::cos(r);
      ts[static_cast<std::size_t>(read.port)] += std::sin(r);
    }
    // phasor(port) * conj(phasor(first port)): the tag's own offset cancels
    for (std::size_t p = 1; p < state.ports.size(); ++p) {
      c[p] += tc[p] * tc[0] + ts[p] * ts[0];
      s[p] += ts[p] * tc[0] - tc[p] * ts[0];
    }
    state.tags[t].offset_rad = std::atan2(ts[0], tc[0]);
  }
  for (std::size_t p = 1; p < state.ports.size(); ++p) state.ports[p].offset_rad = std::atan2(s[p], c[p]);
}

// Places each tag at its best mode; ports coherent or not.
void place_tags(const JointProblem& problem, const BeamModel& beams, const StartOptions& o, bool coherent, JointState& state) {
  for (std::size_t t = 0; t < problem.reads.size(); ++t) {
    if (coherent) {
      const auto modes = find_modes(problem, t, state, beams, {.range_max_m = o.range_max_m, .max_peaks = 8}, true, o.max_reads);
      if (!modes.empty()) state.tags[t] = modes[0].tag;
    } else {
      const std::vector<SpectrumRead> reads = spectrum_reads(problem.reads[t], state, beams, false, o.max_reads);
      const auto peaks = search_near_field(reads, spectrum_options(reads, o.fine_cell_m, o, 1));
      if (!peaks.empty()) state.tags[t].p_W_X = peaks[0].p_W_X;
    }
  }
}

StartCandidate refine(const JointProblem& problem, const JointState& blank, double log_scale, const BeamModel& beams,
                      const StartOptions& o) {
  JointProblem p = problem;
  p.reference_scale_m = std::exp(log_scale);
  StartCandidate c;
  c.state = blank;
  c.state.log_scale = log_scale;
  place_tags(p, beams, o, false, c.state);
  estimate_port_offsets(p, c.state);
  double cost = solve(p, {.max_iterations = 8}, c.state).cost;
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    JointState again = c.state;
    place_tags(p, beams, o, true, again);
    const double again_cost = solve(p, {.max_iterations = 10}, again).cost;
    if (again_cost >= cost) break;
    cost = again_cost;
    c.state = again;
  }
  c.evidence = evidence(p, c.state);
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
  std::vector<StartCandidate> found;
  for (const ScalePower& s : best_scales(part, blank, all, beams, options)) {
    StartCandidate c = refine(part, blank, s.log_scale, beams, options);
    JointState whole = state;
    whole.log_scale = c.state.log_scale;
    whole.time_offset_s = c.state.time_offset_s;
    whole.ports = c.state.ports;
    whole.knots = c.state.knots;
    for (std::size_t i = 0; i < used.size(); ++i) whole.tags[used[i]] = c.state.tags[i];
    found.push_back({std::move(whole), used, c.evidence});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const StartCandidate& a, const StartCandidate& b) { return a.evidence > b.evidence; });
  return found;
}

}  // namespace rfmvo
