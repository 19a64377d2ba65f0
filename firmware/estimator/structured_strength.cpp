#include "estimator/structured_strength.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "estimator/chain_whitening.hpp"

namespace rfmvo {
namespace {

constexpr int kGrid = 24;
constexpr double kGridMin_rad = 0.05, kGridRatio = 1.16;  // 0.05 .. 1.5 rad, log-spaced

double grid_rad(int i) { return kGridMin_rad * std::pow(kGridRatio, i); }

using LogLikelihood = std::array<double, kGrid>;

// Restricted likelihood: the four unknowns of the tag are integrated out (-1/2 ln det J^T J).
LogLikelihood of_tag(const JointProblem& problem, const JointState& state, std::size_t t, WhitenedTag& whitened) {
  LogLikelihood l{};
  TagState tag = state.tags[t];
  for (int i = 0; i < kGrid; ++i) {
    tag.structured_sigma_rad = grid_rad(i);
    whiten(problem.reads[t], problem, state, tag, true, whitened);
    Eigen::Matrix4d H = 1e-3 * Eigen::Matrix4d::Identity();
    for (const WhitenedRow& row : whitened.rows) H += row.weight * row.tag * row.tag.transpose();
    l[static_cast<std::size_t>(i)] =
        -whitened.cost - 0.5 * whitened.log_variance - 0.5 * std::log(H.determinant());
  }
  return l;
}

double log_normal(double value, double centre, double log_sigma) {
  const double z = std::log(value / centre) / log_sigma;
  return -0.5 * z * z;
}

// Mean of ln(sigma) under the weights exp(l): steadier than the argmax on a coarse grid.
double posterior_rad(const LogLikelihood& l) {
  const double top = *std::max_element(l.begin(), l.end());
  double sum = 0.0, mean = 0.0;
  for (int i = 0; i < kGrid; ++i) {
    const double w = std::exp(l[static_cast<std::size_t>(i)] - top);
    sum += w;
    mean += w * std::log(grid_rad(i));
  }
  return std::exp(mean / sum);
}

}  // namespace

void estimate_structured_strength(const JointProblem& problem, const StrengthOptions& options, JointState& state) {
  WhitenedTag whitened;
  std::vector<LogLikelihood> tags;
  LogLikelihood site{};
  for (int i = 0; i < kGrid; ++i)
    site[static_cast<std::size_t>(i)] = log_normal(grid_rad(i), options.prior_rad, options.prior_log_sigma);
  for (std::size_t t = 0; t < problem.reads.size(); ++t) {
    tags.push_back(of_tag(problem, state, t, whitened));
    for (std::size_t i = 0; i < kGrid; ++i) site[i] += tags.back()[i];
  }
  const double pooled = posterior_rad(site);
  for (std::size_t t = 0; t < tags.size(); ++t) {
    for (int i = 0; i < kGrid; ++i)
      tags[t][static_cast<std::size_t>(i)] += log_normal(grid_rad(i), pooled, options.tag_log_sigma);
    state.tags[t].structured_sigma_rad = std::max(posterior_rad(tags[t]), options.floor_rad);
  }
}

}  // namespace rfmvo
