// Strength of the structured phase error, from the residuals themselves: restricted maximum
// likelihood per tag, pooled over tags where a tag alone says little. docs/estimator.md, section 6.
#pragma once

#include "estimator/joint_problem.hpp"

namespace rfmvo {

struct StrengthOptions {
  double floor_rad = 0.15;
  double prior_rad = 0.4;        // typical strength,
  double prior_log_sigma = 0.6;  // of the typical strength over sites,
  double tag_log_sigma = 0.25;   // and of a tag's strength about its site's
};

// Writes structured_sigma_rad of every tag in state.
void estimate_structured_strength(const JointProblem& problem, const StrengthOptions& options, JointState& state);

// Shares of reads that are flipped by pi and that tell nothing, as the residuals show; weighed against what is usual
// as if that had been seen in `kUsualReads` reads.
struct Misreads {
  double flips = 0.003, outliers = 0.01;
};
[[nodiscard]] Misreads estimate_misreads(const JointProblem& problem, const JointState& state, const Misreads& usual);

// How much stronger the error is where a tag answers weakly: what suits all tags' residuals best, whatever the
// site's strength.
[[nodiscard]] double estimate_fade_exponent(JointProblem problem, const JointState& state,
                                            const StrengthOptions& options);

// The correlation length and share of long echoes that suit all tags' residuals best, weighed against `usual_m` (a
// site's lengths scatter about it by a factor of e^0.5). The fade exponent stays.
[[nodiscard]] StructuredShape estimate_correlation(const JointProblem& problem, const JointState& state,
                                                   double usual_m);

}  // namespace rfmvo
