#include "vision/bundle_system.hpp"

#include <Eigen/LU>

#include "vision/reprojection.hpp"

namespace rfmvo {
namespace {

constexpr double kBehindCost_px2 = 1e4;  // of a point behind a camera: never better than any visible outlier

}  // namespace

BundleSystem::BundleSystem(const BundleProblem& problem, const BundleOptions& options)
    : problem_(problem), options_(options) {
  for (const BundleView& view : problem.views) slot_.push_back(view.fixed ? -1 : free_++);
  first_.assign(problem.points_V.size() + 1, 0);
  for (const BundleObservation& o : problem.observations) ++first_[static_cast<std::size_t>(o.point) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  H_view_.resize(static_cast<std::size_t>(free_));
  b_view_.resize(static_cast<std::size_t>(free_));
  H_point_.resize(problem.points_V.size());
  b_point_.resize(problem.points_V.size());
  W_.resize(problem.observations.size());
  b_observation_.resize(problem.observations.size());
  step_point_.resize(problem.points_V.size());
  lens_ = problem.lens.free ? kLens : 0;
  step_camera_.resize(6 * free_ + lens_);
  S_views_.resize(static_cast<std::size_t>(free_ * (free_ + 1) / 2));
  if (!problem.lens.free) return;
  W_lens_.resize(problem.points_V.size());
  b_lens_point_.resize(problem.points_V.size());
  H_lens_view_.resize(static_cast<std::size_t>(free_));
}

Eigen::Vector2d BundleSystem::measured(const BundleObservation& o, const LensVector& lens) const {
  return lens_ > 0 ? Eigen::Vector2d(o.measured + o.d_lens * lens) : o.measured;
}

double BundleSystem::cost(const std::vector<BundleView>& views, const std::vector<Eigen::Vector3d>& points,
                          const LensVector& lens) const {
  std::vector<Eigen::Matrix3d> R;
  for (const BundleView& view : views) R.push_back(view.T_C_V.R_C_V.toRotationMatrix());
  double sum = 0.0;
  if (lens_ > 0) {
    const LensVector off = lens - problem_.lens.expected;
    sum = off.dot(problem_.lens.information * off);
  }
  for (const BundleObservation& o : problem_.observations) {
    const auto v = static_cast<std::size_t>(o.view);
    const Eigen::Vector3d p_C = R[v] * points[static_cast<std::size_t>(o.point)] + views[v].T_C_V.t_C_V;
    const Reprojection r = reproject(p_C, measured(o, lens), options_.focal_px * o.scale);
    sum += r.in_front ? huber_cost(r.error_px.norm(), options_.huber_px) : kBehindCost_px2;
  }
  return sum;
}

void BundleSystem::linearise() {
  for (Matrix6d& H : H_view_) H.setZero();
  for (Vector6d& b : b_view_) b.setZero();
  for (Matrix26d& H : H_lens_view_) H.setZero();
  if (lens_ > 0) {
    H_lens_ = problem_.lens.information;
    b_lens_ = H_lens_ * (problem_.lens.expected - problem_.lens.step);
  }
  std::vector<Eigen::Matrix3d> R;
  for (const BundleView& view : problem_.views) R.push_back(view.T_C_V.R_C_V.toRotationMatrix());
  for (std::size_t p = 0; p < problem_.points_V.size(); ++p) {
    H_point_[p].setZero();
    b_point_[p].setZero();
    if (lens_ > 0) W_lens_[p].setZero(), b_lens_point_[p].setZero();
    for (std::size_t k = first_[p]; k < first_[p + 1]; ++k) add_observation(k, p, R);
  }
}

void BundleSystem::add_observation(std::size_t k, std::size_t p, const std::vector<Eigen::Matrix3d>& R) {
  const BundleObservation& o = problem_.observations[k];
  const auto v = static_cast<std::size_t>(o.view);
  const Eigen::Vector3d p_C = R[v] * problem_.points_V[p] + problem_.views[v].T_C_V.t_C_V;
  const Reprojection r = reproject(p_C, measured(o, problem_.lens.step), options_.focal_px * o.scale);
  W_[k].setZero();
  b_observation_[k].setZero();
  if (!r.in_front) return;
  const double w = huber_weight(r.error_px.norm(), options_.huber_px);
  const Eigen::Matrix<double, 2, 3> J_point = r.d_camera_point * R[v];
  const Eigen::Matrix<double, 2, 3> weighted = w * J_point;
  H_point_[p].noalias() += weighted.transpose() * J_point;
  b_point_[p].noalias() -= weighted.transpose() * r.error_px;
  const LensJacobian J_lens = -options_.focal_px * o.scale * o.d_lens;
  if (lens_ > 0) add_lens(p, J_lens, w, J_point, r.error_px);
  if (slot_[v] < 0) return;
  const auto s = static_cast<std::size_t>(slot_[v]);
  const Matrix26d J_pose = d_pose(r, p_C);
  const Matrix26d weighted_pose = w * J_pose;
  H_view_[s].noalias() += weighted_pose.transpose() * J_pose;
  b_observation_[k].noalias() = -weighted_pose.transpose() * r.error_px;
  b_view_[s] += b_observation_[k];
  W_[k].noalias() = weighted_pose.transpose() * J_point;
  if (lens_ > 0) H_lens_view_[s].noalias() += J_lens.transpose() * weighted_pose;
}

void BundleSystem::add_lens(std::size_t p, const LensJacobian& J_lens, double w,
                            const Eigen::Matrix<double, 2, 3>& J_point, const Eigen::Vector2d& error_px) {
  const LensJacobian weighted = w * J_lens;
  H_lens_.noalias() += weighted.transpose() * J_lens;
  const LensVector b = -weighted.transpose() * error_px;
  b_lens_ += b;
  b_lens_point_[p] += b;
  W_lens_[p].noalias() += weighted.transpose() * J_point;
}

bool BundleSystem::step(double damping) {
  if (!reduce(damping)) return false;
  if (b_.size() > 0) step_camera_ = llt_.solve(b_);
  for (std::size_t p = 0; p < problem_.points_V.size(); ++p) {
    Eigen::Vector3d rest = b_point_[p];
    for (std::size_t k = first_[p]; k < first_[p + 1]; ++k) {
      const int s = slot_[static_cast<std::size_t>(problem_.observations[k].view)];
      if (s >= 0) rest.noalias() -= W_[k].transpose() * step_camera_.segment<6>(6 * s);
    }
    if (lens_ > 0) rest.noalias() -= W_lens_[p].transpose() * step_camera_.tail<kLens>();
    step_point_[p] = H_inverse_[p] * rest;
  }
  return true;
}

bool BundleSystem::reduce(double damping) {
  const int n = size();
  S_.setZero(n, n);
  b_.resize(n);
  for (int s = 0; s < free_; ++s) {
    const auto i = static_cast<std::size_t>(s);
    Matrix6d H = H_view_[i];
    H.diagonal() += damping * H.diagonal() + Vector6d::Constant(1e-9);
    block(s, s) = H;
    for (int c = 0; c < s; ++c) block(s, c).setZero();
    b_.segment<6>(6 * s) = b_view_[i];
    if (lens_ > 0) S_.block<kLens, 6>(6 * free_, 6 * s) = H_lens_view_[i];
  }
  if (lens_ > 0) {
    S_.bottomRightCorner<kLens, kLens>() = H_lens_;
    S_.diagonal().tail<kLens>() += damping * H_lens_.diagonal();
    b_.tail<kLens>() = b_lens_;
  }
  H_inverse_.resize(problem_.points_V.size());
  for (std::size_t p = 0; p < problem_.points_V.size(); ++p) eliminate(p, damping);
  for (int row = 0; row < free_; ++row) {
    for (int column = 0; column <= row; ++column) S_.block<6, 6>(6 * row, 6 * column) = block(row, column);
  }
  if (n > 0) llt_.compute(S_);  // reads the lower triangle only
  return n == 0 || llt_.info() == Eigen::Success;
}

void BundleSystem::eliminate(std::size_t p, double damping) {
  Eigen::Matrix3d H = H_point_[p];
  H.diagonal() += damping * H.diagonal() + Eigen::Vector3d::Constant(1e-9);
  H_inverse_[p] = H.inverse();
  for (std::size_t i = first_[p]; i < first_[p + 1]; ++i) {
    const int row = slot_[static_cast<std::size_t>(problem_.observations[i].view)];
    if (row < 0) continue;
    const Matrix63d Y = W_[i] * H_inverse_[p];
    b_.segment<6>(6 * row).noalias() -= Y * b_point_[p];
    for (std::size_t j = first_[p]; j < first_[p + 1]; ++j) {
      const int column = slot_[static_cast<std::size_t>(problem_.observations[j].view)];
      if (column < 0 || column > row) continue;
      block(row, column).noalias() -= Y.lazyProduct(W_[j].transpose());
    }
    if (lens_ > 0) S_.block<kLens, 6>(6 * free_, 6 * row).noalias() -= W_lens_[p].lazyProduct(Y.transpose());
  }
  if (lens_ == 0) return;
  const Eigen::Matrix<double, kLens, 3> Y = W_lens_[p] * H_inverse_[p];
  b_.tail<kLens>().noalias() -= Y * b_point_[p];
  S_.bottomRightCorner<kLens, kLens>().noalias() -= Y * W_lens_[p].transpose();
}

bool BundleSystem::hold(const Eigen::VectorXd& direction, double weight) {
  S_.selfadjointView<Eigen::Lower>().rankUpdate(direction, weight);
  llt_.compute(S_);
  return llt_.info() == Eigen::Success;
}

}  // namespace rfmvo
