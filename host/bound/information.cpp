#include "bound/information.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/assert.hpp"

namespace rfmvo::bound {
namespace {

using Chains = std::map<std::pair<std::size_t, std::size_t>, std::vector<Read>>;

Chains chains_of(const World& world) {
  Chains chains;
  for (const Read& read : world.reads) chains[{read.tag, read.port}].push_back(read);
  return chains;
}

// Adds J^T C^-1 J of one chain to the lower triangle.
void add_chain(const std::vector<Read>& chain, const World& world, const Columns& columns, Eigen::MatrixXd& H) {
  std::vector<SparseRow> rows;
  std::vector<int> used;
  for (const Read& read : chain) {
    rows.push_back(columns.of_read(read));
    for (const auto& [column, value] : rows.back()) used.push_back(column);
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(std::ssize(rows), std::ssize(used));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& [column, value] : rows[i]) {
      const auto local = std::lower_bound(used.begin(), used.end(), column) - used.begin();
      J(static_cast<Eigen::Index>(i), local) += value;
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> error(error_covariance(chain, world.structured));
  RFMVO_ASSERT(error.info() == Eigen::Success);  // white noise on the diagonal
  error.matrixL().solveInPlace(J);
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(J.cols(), J.cols());
  block.selfadjointView<Eigen::Lower>().rankUpdate(J.transpose());
  for (Eigen::Index b = 0; b < J.cols(); ++b) {
    for (Eigen::Index a = b; a < J.cols(); ++a)
      H(used[static_cast<std::size_t>(a)], used[static_cast<std::size_t>(b)]) += block(a, b);
  }
}

}  // namespace

Eigen::MatrixXd error_covariance(const std::vector<Read>& chain, const StructuredError& structured) {
  const auto n = std::ssize(chain);
  Eigen::MatrixXd C(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double lengths =
          std::abs(chain[static_cast<std::size_t>(i)].arc_m - chain[static_cast<std::size_t>(j)].arc_m) /
          structured.length_m;
      const double correlation = std::exp(structured.exponential ? -lengths : -0.5 * lengths * lengths);
      C(i, j) = structured.sigma_rad * structured.sigma_rad * correlation;
    }
    const double white_rad = chain[static_cast<std::size_t>(i)].white_rad;
    C(i, i) += white_rad * white_rad;
  }
  return C;
}

Information::Information(const World& world, const Columns& columns) {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(columns.size(), columns.size());
  for (const auto& [pair, chain] : chains_of(world)) add_chain(chain, world, columns, H);
  for (int i = 0; i < columns.size(); ++i) {
    const double sigma = columns.sigmas()[static_cast<std::size_t>(i)];
    H(i, i) += 1.0 / (sigma * sigma);
  }
  unit_ = H.diagonal().cwiseSqrt().cwiseInverse();
  for (int j = 0; j < columns.size(); ++j) H.col(j) = H.col(j).cwiseProduct(unit_) * unit_[j];
  cholesky_.compute(H);
  RFMVO_ASSERT(cholesky_.info() == Eigen::Success);  // every unknown has a prior
}

Eigen::MatrixXd Information::covariance(const Eigen::MatrixXd& rows) const {
  Eigen::MatrixXd whitened = unit_.asDiagonal() * rows.transpose();
  cholesky_.matrixL().solveInPlace(whitened);
  return whitened.transpose() * whitened;
}

}  // namespace rfmvo::bound
