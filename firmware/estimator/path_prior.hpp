// What is known of the states before any phase: the odometry drifts like a random walk, lever arms
// are as measured, electrical lengths and the time offset are roughly known. docs/estimator.md, section 3.
//
// Odometry model (frames W axes, n unscaled): dX_true = scale (1 + epsilon) exp(theta) dn, epsilon and
// theta random walks in metres of travel; d is the integral of what epsilon and theta change.
#pragma once

#include <Eigen/Core>

#include "estimator/joint_problem.hpp"
#include "estimator/joint_solver.hpp"

namespace rfmvo {

// Returns 1/2 the sum of squared normalised residuals; adds J^T J to the lower triangle of H and
// -J^T r to g where they are given.
double add_path_prior(const JointProblem& problem, const JointState& state, const SharedLayout& layout,
                      Eigen::MatrixXd* H, Eigen::VectorXd* g);

}  // namespace rfmvo
