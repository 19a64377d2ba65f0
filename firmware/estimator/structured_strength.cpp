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

constexpr int kGrid = 13;
constexpr double kGridMin_rad = 0.06, kGridRatio = 1.3;  // 0.06 .. 1.4 rad, log-spaced

double grid_rad(int i) { return kGridMin_rad * std::pow(kGridRatio, i); }

using LogLikelihood = std::array<double, kGrid>;

// Restricted likelihood: the four unknowns of the tag are integrated out (-1/2 ln det J^T J).
// whitened.raws are the tag's.
double restricted_log_likelihood(const JointProblem& problem, std::size_t t, const ChainConditioning& conditioning,
                                 WhitenedTag& whitened) {
  whiten_rows(problem.reads[t], problem, conditioning, Derivatives::kTag, whitened);
  Eigen::Matrix4d H = 1e-3 * Eigen::Matrix4d::Identity();
  for (const WhitenedRow& row : whitened.rows) H += row.weight * row.tag * row.tag.transpose();
  return -whitened.cost - 0.5 * whitened.log_variance - 0.5 * std::log(H.determinant());
}

LogLikelihood of_tag(const JointProblem& problem, const JointState& state, std::size_t t, WhitenedTag& whitened) {
  LogLikelihood l{};
  predict_rows(problem.reads[t], state, state.tags[t], Derivatives::kAll, whitened);
  ChainConditioning conditioning = condition_chains(problem.reads[t], grid_rad(0), problem.structured);
  for (int i = 0; i < kGrid; ++i) {
    set_strength(grid_rad(i), conditioning);
    l[static_cast<std::size_t>(i)] = restricted_log_likelihood(problem, t, conditioning, whitened);
  }
  return l;
}

double log_normal(double value, double centre, double log_sigma) {
  const double z = std::log(value / centre) / log_sigma;
  return -0.5 * z * z;
}

double log_sum(const LogLikelihood& l) {
  const double top = *std::max_element(l.begin(), l.end());
  double sum = 0.0;
  for (const double value : l) sum += std::exp(value - top);
  return top + std::log(sum);
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

Misreads estimate_misreads(const JointProblem& problem, const JointState& state, const Misreads& usual) {
  constexpr double kUsualReads = 100.0, kMost = 0.5;
  Misreads sum{usual.flips * kUsualReads, usual.outliers * kUsualReads};
  double reads = kUsualReads;
  WhitenedTag whitened;
  for (std::size_t t = 0; t < problem.reads.size(); ++t) {
    whiten(problem.reads[t], problem, state, state.tags[t], false, whitened);
    for (const WhitenedRow& row : whitened.rows) {
      sum.outliers += 1.0 - row.weight;
      sum.flips += row.flipped ? row.weight : 0.0;
      reads += 1.0;
    }
  }
  return {std::min(kMost, sum.flips / reads), std::min(kMost, sum.outliers / reads)};
}

double estimate_fade_exponent(JointProblem problem, const JointState& state, const StrengthOptions& options) {
  constexpr std::array<double, 7> kExponents{0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5};
  std::array<double, kExponents.size()> l{};
  WhitenedTag whitened;
  for (std::size_t k = 0; k < l.size(); ++k) {
    problem.structured.fade_exponent = kExponents[k];
    LogLikelihood site{};
    for (std::size_t i = 0; i < kGrid; ++i)
      site[i] = log_normal(grid_rad(static_cast<int>(i)), options.prior_rad, options.prior_log_sigma);
    for (std::size_t t = 0; t < problem.reads.size(); ++t) {
      const LogLikelihood tag = of_tag(problem, state, t, whitened);
      for (std::size_t i = 0; i < kGrid; ++i) site[i] += tag[i];
    }
    l[k] = log_sum(site);
  }
  const double top = *std::max_element(l.begin(), l.end());
  double sum = 0.0, mean = 0.0;
  for (std::size_t k = 0; k < l.size(); ++k) {
    sum += std::exp(l[k] - top);
    mean += std::exp(l[k] - top) * kExponents[k];
  }
  return mean / sum;
}

StructuredShape estimate_correlation(const JointProblem& problem, const JointState& state, double usual_m) {
  constexpr std::array<double, 6> kLengths_m{0.03, 0.045, 0.065, 0.095, 0.14, 0.2};
  constexpr std::array<double, 4> kLongShares{0.0, 0.2, 0.4, 0.6};
  constexpr double kSiteLogSigma = 0.5;
  std::vector<std::pair<StructuredShape, double>> shapes;  // with their ln posterior
  WhitenedTag whitened;
  for (const double length_m : kLengths_m)
    for (const double long_share : kLongShares)
      shapes.push_back(
          {{length_m, problem.structured.fade_exponent, long_share}, log_normal(length_m, usual_m, kSiteLogSigma)});
  for (std::size_t t = 0; t < problem.reads.size(); ++t) {
    predict_rows(problem.reads[t], state, state.tags[t], Derivatives::kAll, whitened);
    for (auto& [shape, l] : shapes)
      l += restricted_log_likelihood(
          problem, t, condition_chains(problem.reads[t], state.tags[t].structured_sigma_rad, shape), whitened);
  }
  double top = shapes[0].second, sum = 0.0, log_length = 0.0, long_share = 0.0;
  for (const auto& [shape, l] : shapes) top = std::max(top, l);
  for (const auto& [shape, l] : shapes) {
    const double w = std::exp(l - top);
    sum += w;
    log_length += w * std::log(shape.length_m);
    long_share += w * shape.long_share;
  }
  return {std::exp(log_length / sum), problem.structured.fade_exponent, long_share / sum};
}

}  // namespace rfmvo
