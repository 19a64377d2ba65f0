#include "estimator/tag_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.hpp"
#include "estimator/principal_axes.hpp"
#include "estimator/tag_climb.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

// Two refined peaks nearer than this are one mode.
constexpr double kSameMode_m = 0.03;
// A mode this much less likely than the best (in ln) is no longer carried.
constexpr double kMaxCostAbove = 40.0;
constexpr std::size_t kMaxModes = 12;  // carried; a circle of positions has no end of them

// The modes and more local maxima of the likelihood from the given places, duplicates and hopeless ones left out.
std::vector<TagMode> refine_all(const std::vector<JointRead>& reads, const JointProblem& problem,
                                const JointState& state, const TagState& like, const BeamModel& beams,
                                const std::vector<Eigen::Vector3d>& places, std::vector<TagMode> modes = {}) {
  TagLikelihood likelihood(reads, problem, state, like.structured_sigma_rad);
  for (const Eigen::Vector3d& place : places) {
    const TagLikelihood::Maximum top = likelihood.climb(place);
    const bool known = std::any_of(modes.begin(), modes.end(),
                                   [&](const TagMode& m) { return (m.tag.p_W_X - top.p_W_X).norm() < kSameMode_m; });
    // A climb may leave the grid that it started on.
    constexpr double kMostReads = 0.5;
    if (known || !top.p_W_X.allFinite() || likelihood.share_within(beams.range_max_m, top.p_W_X) < kMostReads) continue;
    TagState tag = like;
    tag.p_W_X = top.p_W_X;
    tag.offset_rad = top.offset_rad;
    const double signal_cost = signal_strength_cost(reads, state, beams, top.p_W_X);
    // Laplace: the height of the mode times the volume that it holds.
    const double log_evidence = 0.5 * std::log(std::max(top.covariance.determinant(), 1e-300)) - top.cost - signal_cost;
    modes.push_back({tag, top.covariance, top.cost, signal_cost, log_evidence, 0.0});
  }
  std::stable_sort(modes.begin(), modes.end(), [](const TagMode& a, const TagMode& b) { return a.cost < b.cost; });
  while (modes.size() > kMaxModes || (!modes.empty() && modes.back().cost > modes.front().cost + kMaxCostAbove))
    modes.pop_back();
  weigh_modes(modes);
  return modes;
}

}  // namespace

void weigh_modes(std::vector<TagMode>& modes) {
  double sum = 0.0, best = -std::numeric_limits<double>::infinity();
  for (const TagMode& m : modes) best = std::max(best, m.log_evidence);
  for (TagMode& m : modes) sum += m.weight = std::exp(m.log_evidence - best);
  for (TagMode& m : modes) m.weight /= sum;
  std::stable_sort(modes.begin(), modes.end(), [](const TagMode& a, const TagMode& b) { return a.weight > b.weight; });
}

std::vector<SpectrumRead> spectrum_reads(const std::vector<JointRead>& reads, const JointState& state,
                                         const BeamModel& beams, bool coherent, std::size_t max_reads) {
  std::vector<SpectrumRead> out;
  const std::size_t count = std::min(reads.size(), max_reads);
  for (std::size_t k = 0; k < count; ++k) {
    const JointRead& read = reads[k * reads.size() / count];
    const ReadStates states = states_at(read, state, TagState{});
    SpectrumRead s;
    s.p_W_A = antenna_position(read.geometry, states).cast<float>();
    const auto port = static_cast<std::size_t>(read.port);
    s.boresight_W = (read.geometry.R_W_C * beams.boresight_C[port]).cast<float>();
    s.turns_per_m = static_cast<float>(read.geometry.wavenumber_rad_m / kTwoPi);
    const double own =
        read.geometry.frequency_term_rad_m * states.electrical_length_m + (coherent ? states.port_offset_rad : 0.0);
    s.phase_turns = static_cast<float>(wrap_rad(read.phase_rad - own) / kTwoPi);
    s.group = coherent ? 0 : read.port;
    out.push_back(s);
  }
  return out;
}

std::vector<Eigen::Vector3d> PossiblePlaces::at(double other_log_scale) const {
  std::vector<Eigen::Vector3d> grown = p_W_X;
  for (Eigen::Vector3d& p : grown) p *= std::exp(other_log_scale - log_scale);
  return grown;
}

PossiblePlaces search_places(const std::vector<JointRead>& all, const JointState& state, const BeamModel& beams,
                             const PlaceOptions& options) {
  const std::vector<SpectrumRead> reads = spectrum_reads(all, state, beams, false, options.max_reads);
  PossiblePlaces found{{}, state.log_scale};
  const SpectrumOptions grid{.cell_m = suitable_cell(reads, options.finest_m, options.widest_m),
                             .range_max_m = options.range_max_m,
                             .max_peaks = options.count};
  for (const SpectrumPeak& peak : search_near_field(reads, grid)) found.p_W_X.push_back(peak.p_W_X);
  return found;
}

// Where all ports together agree: the lobes of the whole aperture, which the incoherent spectrum does not show.
std::vector<SpectrumPeak> coherent_peaks(const std::vector<SpectrumRead>& reads, const BeamModel& beams) {
  constexpr double kFinest_m = 0.06, kWidest_m = 0.25;
  constexpr int kPeaks = 24;
  return search_near_field(
      reads,
      {.cell_m = suitable_cell(reads, kFinest_m, kWidest_m), .range_max_m = beams.range_max_m, .max_peaks = kPeaks});
}

// Images of the modes that the antennas' places cannot tell from them: mirrored in the plane that the antennas moved in
// and, where that is hardly more than a line, turned about it.
std::vector<Eigen::Vector3d> twin_places(const std::vector<SpectrumRead>& reads, const std::vector<TagMode>& modes) {
  constexpr int kTurns = 12;
  std::vector<Eigen::Vector3d> antennas;
  for (const SpectrumRead& r : reads) antennas.push_back(r.p_W_A.cast<double>());
  const PrincipalAxes shape = principal_axes(antennas);
  constexpr std::size_t kBest = 4;
  std::vector<Eigen::Vector3d> twins;
  for (std::size_t m = 0; m < std::min(kBest, modes.size()); ++m) {
    const Eigen::Vector3d d = modes[m].tag.p_W_X - shape.centre;
    twins.push_back(shape.centre + d - 2.0 * d.dot(shape.normal()) * shape.normal());
    for (int k = 1; shape.is_line() && m == 0 && k < kTurns; ++k)
      twins.push_back(shape.centre + Eigen::AngleAxisd(kTwoPi * k / kTurns, shape.line()) * d);
  }
  return twins;
}

std::vector<TagMode> find_modes(const JointProblem& problem, std::size_t index, const JointState& state,
                                const BeamModel& beams, const std::vector<Eigen::Vector3d>& places, std::size_t count) {
  constexpr std::size_t kReads = 64;
  const std::vector<SpectrumRead> reads = spectrum_reads(problem.reads[index], state, beams, true, kReads);
  std::vector<SpectrumPeak> ranked = coherent_peaks(reads, beams);
  for (const Eigen::Vector3d& p : places) ranked.push_back({p, near_field_power(reads, p), 0.0});
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const SpectrumPeak& a, const SpectrumPeak& b) { return a.power > b.power; });
  if (ranked.size() > count) ranked.resize(count);
  std::vector<Eigen::Vector3d> best;
  for (const SpectrumPeak& peak : ranked) best.push_back(peak.p_W_X);
  std::vector<TagMode> modes = refine_all(problem.reads[index], problem, state, state.tags[index], beams, best);
  if (modes.empty()) return modes;
  // A grid may miss one of two places that fit alike: never leave its twin to chance.
  const std::vector<Eigen::Vector3d> twins = twin_places(reads, modes);
  return refine_all(problem.reads[index], problem, state, state.tags[index], beams, twins, std::move(modes));
}

std::vector<TagMode> refresh_modes(const JointProblem& problem, std::size_t index, const JointState& state,
                                   const BeamModel& beams, const std::vector<TagMode>& modes) {
  std::vector<Eigen::Vector3d> places;
  for (const TagMode& mode : modes) places.push_back(mode.tag.p_W_X);
  return refine_all(problem.reads[index], problem, state, state.tags[index], beams, places);
}

}  // namespace rfmvo
