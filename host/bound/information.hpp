// Fisher information of a run's reads, and covariances from its inverse.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "bound/columns.hpp"

namespace rfmvo::bound {

class Information {
 public:
  Information(const World& world, const Columns& columns);

  // Bound of linear functions of the unknowns: rows H^-1 rows^T.
  [[nodiscard]] Eigen::MatrixXd covariance(const Eigen::MatrixXd& rows) const;

 private:
  Eigen::VectorXd unit_;  // of each unknown, so that the factorised matrix has ones on its diagonal
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
};

// Error covariance of the reads of one (tag, port).
[[nodiscard]] Eigen::MatrixXd error_covariance(const std::vector<Read>& chain, const StructuredError& structured);

}  // namespace rfmvo::bound
