#include "estimator/tag_modes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.hpp"
#include "estimator/chain_whitening.hpp"
#include "estimator/joint_solver.hpp"
#include "rf/phase.hpp"

namespace rfmvo {
namespace {

// Two refined peaks nearer than this are one mode.
constexpr double kSameMode_m = 0.03;
// A mode this much less likely than the best (in ln) is no longer carried.
constexpr double kMaxCostAbove = 12.0;

// The offset that suits the reads best at a position: the angle of the sum of phasors.
double best_offset(const JointProblem& one, const JointState& state, TagState tag) {
  tag.offset_rad = 0.0;
  double c = 0.0, s = 0.0;
  for (const JointRead& read : one.reads[0]) {
    const double r = read.phase_rad - predict_phase(read.geometry, states_at(read, state, tag)).phase_rad;
    c += std::cos(r);
    s += std::sin(r);
  }
  return std::atan2(s, c);
}

Eigen::Matrix4d conditional_covariance(const JointProblem& one, const JointState& state, const TagState& tag) {
  WhitenedTag whitened;
  whiten(one.reads[0], one, state, tag, true, whitened);
  Eigen::Matrix4d H = 1e-4 * Eigen::Matrix4d::Identity();
  for (const WhitenedRow& row : whitened.rows) H += row.weight * row.tag * row.tag.transpose();
  return H.inverse();
}

// Local maxima of the likelihood from the given places, duplicates and hopeless ones left out.
std::vector<TagMode> refine_all(const JointProblem& one, const JointState& state, const TagState& like,
                                const std::vector<Eigen::Vector3d>& places) {
  JointState local = state;
  std::vector<TagMode> modes;
  for (const Eigen::Vector3d& place : places) {
    TagState tag = like;
    tag.p_W_X = place;
    tag.offset_rad = best_offset(one, state, tag);
    local.tags = {tag};
    const SolverReport report = solve(one, {.max_iterations = 10, .shared_fixed = true}, local);
    const bool known = std::any_of(modes.begin(), modes.end(), [&](const TagMode& m) {
      return (m.tag.p_W_X - local.tags[0].p_W_X).norm() < kSameMode_m;
    });
    if (known || !local.tags[0].p_W_X.allFinite()) continue;
    modes.push_back({local.tags[0], conditional_covariance(one, state, local.tags[0]), report.cost, 0.0});
  }
  std::stable_sort(modes.begin(), modes.end(), [](const TagMode& a, const TagMode& b) { return a.cost < b.cost; });
  while (!modes.empty() && modes.back().cost > modes.front().cost + kMaxCostAbove) modes.pop_back();
  weigh_modes(modes);
  return modes;
}

}  // namespace

void weigh_modes(std::vector<TagMode>& modes) {
  double sum = 0.0, best = std::numeric_limits<double>::infinity();
  for (const TagMode& m : modes) best = std::min(best, m.cost);
  for (TagMode& m : modes) {
    // Laplace: the volume that the mode holds, times its height.
    m.weight = std::exp(best - m.cost) * std::sqrt(std::max(m.covariance.topLeftCorner<3, 3>().determinant(), 0.0));
    sum += m.weight;
  }
  for (TagMode& m : modes) m.weight = sum > 0.0 ? m.weight / sum : 0.0;
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
    const double own = read.geometry.frequency_term_rad_m * states.electrical_length_m + (coherent ? states.port_offset_rad : 0.0);
    s.phase_turns = static_cast<float>(wrap_rad(read.phase_rad - own) / kTwoPi);
    s.group = coherent ? 0 : read.port;
    out.push_back(s);
  }
  return out;
}

std::vector<TagMode> find_modes(const JointProblem& problem, std::size_t index, const JointState& state,
                                const BeamModel& beams, SpectrumOptions options, bool coherent,
                                std::size_t max_reads) {
  JointProblem one = problem;
  one.reads = {problem.reads[index]};
  const std::vector<SpectrumRead> reads = spectrum_reads(one.reads[0], state, beams, coherent, max_reads);
  constexpr double kFinest_m = 0.06, kWidest_m = 0.2;
  options.cell_m = suitable_cell(reads, kFinest_m, kWidest_m);
  const std::vector<SpectrumPeak> peaks = search_near_field(reads, options);
  std::vector<Eigen::Vector3d> places;
  for (const SpectrumPeak& peak : peaks) places.push_back(peak.p_W_X);
  return refine_all(one, state, state.tags[index], places);
}

std::vector<TagMode> refresh_modes(const JointProblem& problem, std::size_t index, const JointState& state,
                                   const std::vector<TagMode>& modes) {
  JointProblem one = problem;
  one.reads = {problem.reads[index]};
  std::vector<Eigen::Vector3d> places;
  for (const TagMode& mode : modes) places.push_back(mode.tag.p_W_X);
  return refine_all(one, state, state.tags[index], places);
}

}  // namespace rfmvo
