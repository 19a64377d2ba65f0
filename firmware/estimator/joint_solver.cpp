#include "estimator/joint_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/assert.hpp"
#include "base/units.hpp"
#include "estimator/chain_whitening.hpp"
#include "estimator/path_prior.hpp"

namespace rfmvo {
namespace {

// A tag's position is known to the order of the reading range before any read.
constexpr double kTagPriorSigma_m = 20.0;
constexpr double kTagOffsetPriorSigma_rad = 20.0;

struct TagBlock {
  Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
  Eigen::Vector4d g = Eigen::Vector4d::Zero();
  Eigen::MatrixXd H_shared;  // 4 x shared
};

// J^T J and J^T r of whitened (measured - predicted) rows: H dx = g.
struct NormalEquations {
  SharedLayout layout;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::vector<TagBlock> tags;
  double cost = 0.0;
};

// Column of each non-zero of a row in the reduced system; -1 = fixed.
int gather(const WhitenedRow& row, const SharedLayout& layout, std::array<int, 64>& columns, Eigen::VectorXd& values) {
  int n = 0;
  const auto add = [&](int column, double value) {
    columns[static_cast<std::size_t>(n)] = column;
    values[n++] = value;
  };
  add(SharedLayout::kLogScale, row.globals[0]);
  add(SharedLayout::kTimeOffset, row.globals[1]);
  if (row.port > 0) add(layout.port(row.port), row.globals[2]);
  for (int i = 1; i < SharedLayout::kPerPort; ++i) add(layout.port(row.port) + i, row.globals[2 + i]);
  for (int k = 0; k < row.knots; ++k) {
    if (row.first_knot + k == 0) continue;
    for (int i = 0; i < 6; ++i) add(layout.knot(row.first_knot + k) + i, row.knot[static_cast<std::size_t>(k)][i]);
  }
  return n;
}

void accumulate(const WhitenedTag& whitened, double share, const SharedLayout& layout, bool shared_fixed,
                NormalEquations& eq, TagBlock& block) {
  std::array<int, 64> columns{};
  Eigen::VectorXd values(64);
  for (const WhitenedRow& row : whitened.rows) {
    const double w = share * row.weight;
    block.H.noalias() += w * row.tag * row.tag.transpose();
    block.g.noalias() += w * row.residual * row.tag;
    if (shared_fixed) continue;
    const int n = gather(row, layout, columns, values);
    for (int a = 0; a < n; ++a) {
      const int ca = columns[static_cast<std::size_t>(a)];
      const double wa = w * values[a];
      eq.g[ca] += wa * row.residual;
      block.H_shared.col(ca) += wa * row.tag;
      for (int b = 0; b <= a; ++b) eq.H(ca, columns[static_cast<std::size_t>(b)]) += wa * values[b];
    }
  }
}

void add_tag_prior(double share, TagBlock& block) {
  // Towards the current value: a damping that only matters for directions no read sees.
  block.H.diagonal().head<3>().array() += share / (kTagPriorSigma_m * kTagPriorSigma_m);
  block.H(3, 3) += share / (kTagOffsetPriorSigma_rad * kTagOffsetPriorSigma_rad);
}

using Chains = std::vector<ChainConditioning>;  // per tag

Chains chains_of(const JointProblem& problem, const JointState& state) {
  Chains chains;
  for (std::size_t t = 0; t < problem.reads.size(); ++t)
    chains.push_back(condition_chains(problem.reads[t], state.tags[t].structured_sigma_rad, problem.structured));
  return chains;
}

NormalEquations build(const JointProblem& problem, const Chains& chains, const JointState& state, bool shared_fixed,
                      bool with_prior = true) {
  NormalEquations eq;
  eq.layout = {static_cast<int>(state.ports.size()), static_cast<int>(state.knots.size())};
  const int size = shared_fixed ? 0 : eq.layout.size();
  eq.H = Eigen::MatrixXd::Zero(size, size);
  eq.g = Eigen::VectorXd::Zero(size);
  eq.tags.resize(problem.reads.size());
  WhitenedTag whitened;
  for (std::size_t t = 0; t < problem.reads.size(); ++t) {
    predict_rows(problem.reads[t], state, state.tags[t], Derivatives::kAll, whitened);
    whiten_rows(problem.reads[t], problem, chains[t], Derivatives::kAll, whitened);
    const double share = share_of(problem, t);
    eq.cost += share * (whitened.cost + 0.5 * whitened.log_variance);
    eq.tags[t].H_shared = Eigen::MatrixXd::Zero(4, size);
    accumulate(whitened, share, eq.layout, shared_fixed, eq, eq.tags[t]);
    add_tag_prior(share, eq.tags[t]);
  }
  if (!shared_fixed) {
    // Rows were gathered in mixed column order; fold everything into the lower triangle.
    for (int r = 0; r < size; ++r)
      for (int c = r + 1; c < size; ++c) {
        eq.H(c, r) += eq.H(r, c);
        eq.H(r, c) = 0.0;
      }
    if (with_prior) eq.cost += add_path_prior(problem, state, eq.layout, &eq.H, &eq.g);
  }
  return eq;
}

// S becomes the lower triangle of S - H_st H_tt^-1 H_ts.
void eliminate(const Eigen::LLT<Eigen::Matrix4d>& tag_information, const Eigen::MatrixXd& H_shared,
               Eigen::MatrixXd& S) {
  const Eigen::MatrixXd L_inverse_H = tag_information.matrixL().solve(H_shared);
  S.selfadjointView<Eigen::Lower>().rankUpdate(L_inverse_H.transpose(), -1.0);
}

struct Step {
  Eigen::VectorXd shared;
  std::vector<Eigen::Vector4d> tags;
  double predicted_decrease = 0.0;
};

Eigen::Matrix4d damped(const Eigen::Matrix4d& H, double lambda) {
  Eigen::Matrix4d D = H;
  D.diagonal() *= 1.0 + lambda;
  return D;
}

Step damped_step(const NormalEquations& eq, double lambda) {
  const int size = static_cast<int>(eq.g.size());
  Step step;
  step.shared = Eigen::VectorXd::Zero(size);
  step.tags.resize(eq.tags.size());
  if (size > 0) {
    Eigen::MatrixXd S = eq.H;
    S.diagonal() *= 1.0 + lambda;
    Eigen::VectorXd rhs = eq.g;
    for (const TagBlock& tag : eq.tags) {
      const Eigen::LLT<Eigen::Matrix4d> llt(damped(tag.H, lambda));
      eliminate(llt, tag.H_shared, S);
      rhs.noalias() -= tag.H_shared.transpose() * llt.solve(tag.g);
    }
    step.shared = S.selfadjointView<Eigen::Lower>().ldlt().solve(rhs);
  }
  step.predicted_decrease = 0.5 * eq.g.dot(step.shared);
  for (std::size_t t = 0; t < eq.tags.size(); ++t) {
    const TagBlock& tag = eq.tags[t];
    Eigen::Vector4d rhs = tag.g;
    if (size > 0) rhs.noalias() -= tag.H_shared * step.shared;
    step.tags[t] = damped(tag.H, lambda).llt().solve(rhs);
    step.predicted_decrease += 0.5 * tag.g.dot(step.tags[t]);
  }
  return step;
}

JointState apply(const JointState& state, const Step& step, const SharedLayout& layout) {
  JointState s = state;
  if (step.shared.size() > 0) {
    s.log_scale += step.shared[SharedLayout::kLogScale];
    s.time_offset_s += step.shared[SharedLayout::kTimeOffset];
    for (int p = 0; p < layout.ports; ++p) {
      PortState& port = s.ports[static_cast<std::size_t>(p)];
      if (p > 0) port.offset_rad += step.shared[layout.port(p)];
      port.electrical_length_m += step.shared[layout.port(p) + 1];
      port.lever_arm_C += step.shared.segment<3>(layout.port(p) + 2);
    }
    for (int k = 1; k < layout.knots; ++k) {
      KnotState& knot = s.knots[static_cast<std::size_t>(k)];
      knot.path_correction_W += step.shared.segment<3>(layout.knot(k));
      knot.rotation_correction_W += step.shared.segment<3>(layout.knot(k) + 3);
      knot.log_scale_drift += step.shared[layout.knot(k) + 6];
    }
  }
  for (std::size_t t = 0; t < step.tags.size(); ++t) {
    s.tags[t].p_W_X += step.tags[t].head<3>();
    s.tags[t].offset_rad += step.tags[t][3];
  }
  return s;
}

double cost_of(const JointProblem& problem, const Chains& chains, const JointState& state) {
  double cost = 0.0;
  WhitenedTag whitened;
  for (std::size_t t = 0; t < problem.reads.size(); ++t) {
    predict_rows(problem.reads[t], state, state.tags[t], Derivatives::kNone, whitened);
    whiten_rows(problem.reads[t], problem, chains[t], Derivatives::kNone, whitened);
    cost += share_of(problem, t) * (whitened.cost + 0.5 * whitened.log_variance);
  }
  const SharedLayout layout{static_cast<int>(state.ports.size()), static_cast<int>(state.knots.size())};
  return cost + add_path_prior(problem, state, layout, nullptr, nullptr);
}

}  // namespace

double total_cost(const JointProblem& problem, const JointState& state) {
  return cost_of(problem, chains_of(problem, state), state);
}

double evidence(const JointProblem& problem, const JointState& state) {
  // A uniform phase has density 1 / (2 pi); costs leave out the Gaussian's sqrt(2 pi).
  const double uniform_cost = std::log(kTwoPi) - 0.5 * std::log(kTwoPi);
  constexpr double kLogPlaces = 11.5;  // about 1e5 cells of the near-field grid in reach of a tag's reads
  double sum = 0.0;
  WhitenedTag whitened;
  for (std::size_t t = 0; t < problem.reads.size(); ++t) {
    whiten(problem.reads[t], problem, state, state.tags[t], false, whitened);
    sum += uniform_cost * static_cast<double>(problem.reads[t].size()) - whitened.cost - 0.5 * whitened.log_variance -
           kLogPlaces;
  }
  const SharedLayout layout{static_cast<int>(state.ports.size()), static_cast<int>(state.knots.size())};
  return sum - add_path_prior(problem, state, layout, nullptr, nullptr);
}

SolverReport solve(const JointProblem& problem, const SolverOptions& options, JointState& state) {
  RFMVO_ASSERT(problem.reads.size() == state.tags.size());
  RFMVO_ASSERT(problem.intervals.size() + 1 == state.knots.size());
  constexpr double kFirstLambda = 1e-4, kMaxLambda = 1e6;
  double lambda = kFirstLambda;
  SolverReport report;
  const Chains chains = chains_of(problem, state);
  report.cost = cost_of(problem, chains, state);
  while (report.iterations < options.max_iterations) {
    ++report.iterations;
    const NormalEquations eq = build(problem, chains, state, options.shared_fixed);
    bool improved = false;
    while (!improved && lambda < kMaxLambda) {
      const Step step = damped_step(eq, lambda);
      const JointState candidate = apply(state, step, eq.layout);
      const double cost = cost_of(problem, chains, candidate);
      improved = cost < report.cost;
      if (improved) {
        const double decrease = report.cost - cost;
        state = candidate;
        report.cost = cost;
        report.converged = decrease < options.step_tolerance * (1.0 + std::abs(cost));
        lambda = std::max(lambda * 0.1, 1e-9);
      } else {
        report.converged = step.predicted_decrease < options.step_tolerance * (1.0 + std::abs(report.cost));
        lambda *= 10.0;
        if (report.converged) break;
      }
    }
    if (report.converged || !improved) break;
  }
  return report;
}

namespace {

// Of `whole` less `missing`, or, where too much is missing for a quadratic, less as much of it as leaves a tenth.
Eigen::MatrixXd inverse_without(const Eigen::MatrixXd& whole, const Eigen::MatrixXd& missing) {
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(whole.rows(), whole.cols());
  if (missing.size() == 0) return whole.ldlt().solve(identity);
  // In coordinates in which `whole` is the identity, `missing` may take 90 % of any direction.
  const Eigen::LLT<Eigen::MatrixXd> llt(whole);
  Eigen::MatrixXd M = llt.matrixL().solve(missing);
  M = llt.matrixL().solve(M.transpose().eval()).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(M);
  constexpr double kMostMissing = 0.9;
  const Eigen::VectorXd left = (1.0 - eigen.eigenvalues().array().max(0.0).min(kMostMissing)).inverse();
  const Eigen::MatrixXd half = llt.matrixU().solve(eigen.eigenvectors());
  return half * left.asDiagonal() * half.transpose();
}

}  // namespace

JointCovariance covariance(const JointProblem& problem, const JointState& state, const Eigen::MatrixXd& missing,
                           double tails) {
  const NormalEquations eq = build(problem, chains_of(problem, state), state, false);
  Eigen::MatrixXd S = eq.H;
  std::vector<Eigen::MatrixXd> gain(eq.tags.size());  // H_tt^-1 H_ts
  for (std::size_t t = 0; t < eq.tags.size(); ++t) {
    const Eigen::LLT<Eigen::Matrix4d> llt(eq.tags[t].H);
    gain[t] = llt.solve(eq.tags[t].H_shared);
    eliminate(llt, eq.tags[t].H_shared, S);
  }
  JointCovariance c;
  c.layout = eq.layout;
  c.information = S.selfadjointView<Eigen::Lower>();
  c.shared = tails * tails * inverse_without(c.information, missing);
  c.shared = (0.5 * (c.shared + c.shared.transpose())).eval();
  for (std::size_t t = 0; t < eq.tags.size(); ++t) {
    const Eigen::MatrixXd cross = gain[t] * c.shared;
    const Eigen::Matrix4d own = share_of(problem, t) * eq.tags[t].H.llt().solve(Eigen::Matrix4d::Identity());
    c.tag.emplace_back(own + cross * gain[t].transpose());
    c.tag_shared.emplace_back(-cross);
  }
  return c;
}

TagCoupling tag_coupling(const JointProblem& problem, const JointState& state) {
  RFMVO_ASSERT(problem.reads.size() == 1);
  const NormalEquations eq = build(problem, chains_of(problem, state), state, false, false);
  const TagBlock& tag = eq.tags[0];
  TagCoupling c;
  c.own_covariance = tag.H.llt().solve(Eigen::Matrix4d::Identity());
  c.H_shared = tag.H_shared;
  c.information = eq.H.selfadjointView<Eigen::Lower>();
  c.information.noalias() -= tag.H_shared.transpose() * c.own_covariance * tag.H_shared;
  c.gradient = eq.g - tag.H_shared.transpose() * (c.own_covariance * tag.g);
  return c;
}

// ln det of the prior's information, with a scale known to a factor of e: the volume that the states may fill
// before any read.
double log_prior_determinant(const JointProblem& problem, const JointState& state, const SharedLayout& layout) {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(layout.size(), layout.size());
  Eigen::VectorXd g = Eigen::VectorXd::Zero(layout.size());
  (void)add_path_prior(problem, state, layout, &H, &g);
  H(SharedLayout::kLogScale, SharedLayout::kLogScale) += 1.0;
  const Eigen::MatrixXd whole = H.selfadjointView<Eigen::Lower>();
  return whole.ldlt().vectorD().array().abs().log().sum();
}

double log_marginal_likelihood(const JointProblem& problem, const JointState& state) {
  const NormalEquations eq = build(problem, chains_of(problem, state), state, false);
  // Of one read a Gaussian's sqrt(2 pi) against 2 pi of a uniform phase; of a tag Laplace's (2 pi)^2 against the
  // offset's 2 pi and the space that a tag may be in.
  constexpr double kSpace_m3 = 100.0;
  const double per_read = 0.5 * std::log(kTwoPi), per_tag = std::log(kTwoPi / kSpace_m3);
  Eigen::MatrixXd S = eq.H;
  double likelihood = 0.5 * log_prior_determinant(problem, state, eq.layout) - eq.cost;
  for (std::size_t t = 0; t < eq.tags.size(); ++t) {
    const TagBlock& tag = eq.tags[t];
    eliminate(Eigen::LLT<Eigen::Matrix4d>(tag.H), tag.H_shared, S);
    const double share = share_of(problem, t);
    const double log_determinant = std::log(tag.H.determinant()) - 4.0 * std::log(share);
    likelihood += share * (per_read * static_cast<double>(problem.reads[t].size()) + per_tag - 0.5 * log_determinant -
                           std::log(share));
  }
  const Eigen::MatrixXd whole = S.selfadjointView<Eigen::Lower>();
  return likelihood - 0.5 * whole.ldlt().vectorD().array().abs().log().sum();
}

}  // namespace rfmvo
