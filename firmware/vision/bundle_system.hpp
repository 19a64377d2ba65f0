// The normal equations of a bundle adjustment, and what is left of them for the cameras (Schur complement).
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "vision/bundle_adjustment.hpp"

namespace rfmvo {

// Our own Schur complement instead of Ceres (DENSE_SCHUR): a prototype of it took, per solve on two shared x86-64
// cores, 2.2..4.4 ms for 10 key frames where Ceres took 6..8, 6.5 against 17 for 20, 25 against 52 for 60 poses and 279
// points, 44 against 100 for 60 and 750. Not repeated with this code. It also hands out the reduced system, which says
// what the lens wants, and what each landmark has to say about a motion.
class BundleSystem {
 public:
  // Refers to the problem, which may change between calls, but not in size.
  BundleSystem(const BundleProblem& problem, const BundleOptions& options);

  [[nodiscard]] double cost(const std::vector<BundleView>& views, const std::vector<Eigen::Vector3d>& points,
                            const LensVector& lens) const;
  // At the problem's present values.
  void linearise();
  // The system of the camera's unknowns alone (views, then lens), factored; false: not positive definite.
  bool reduce(double damping);
  // Reduces and solves for the steps; false likewise.
  bool step(double damping);

  [[nodiscard]] int size() const { return 6 * free_ + lens_; }
  [[nodiscard]] int slot(std::size_t view) const { return slot_[view]; }  // among the free views; -1: fixed
  [[nodiscard]] bool has_lens() const { return lens_ > 0; }
  [[nodiscard]] const Eigen::VectorXd& step_camera() const { return step_camera_; }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& step_points() const { return step_point_; }
  [[nodiscard]] const Eigen::LLT<Eigen::MatrixXd>& factor() const { return llt_; }
  [[nodiscard]] const Eigen::VectorXd& right_side() const { return b_; }

  // Adds weight * direction direction^T to what reduce() left, and factors again.
  bool hold(const Eigen::VectorXd& direction, double weight);
  // What this point adds to the right side of the reduced system, seen through the rows of `through`.
  template <int kColumns>
  [[nodiscard]] Eigen::Matrix<double, kColumns, 1> pull(
      std::size_t point, const Eigen::Matrix<double, Eigen::Dynamic, kColumns>& through) const;

 private:
  using Matrix63d = Eigen::Matrix<double, 6, 3>;
  using Matrix26d = Eigen::Matrix<double, 2, 6>;
  static constexpr int kLens = LensVector::SizeAtCompileTime;

  [[nodiscard]] Eigen::Vector2d measured(const BundleObservation& o, const LensVector& lens) const;
  void add_observation(std::size_t k, std::size_t p, const std::vector<Eigen::Matrix3d>& R);
  void add_lens(std::size_t p, const LensJacobian& J_lens, double w, const Eigen::Matrix<double, 2, 3>& J_point,
                const Eigen::Vector2d& error_px);
  // Of the lower triangle; dense blocks are quicker to add to than parts of a large matrix.
  [[nodiscard]] Matrix6d& block(int row, int column) {
    return S_views_[static_cast<std::size_t>(row * (row + 1) / 2 + column)];
  }
  void eliminate(std::size_t p, double damping);

  const BundleProblem& problem_;
  const BundleOptions options_;
  int free_ = 0;
  std::vector<int> slot_;           // of each view among the free ones; -1 = fixed
  std::vector<std::size_t> first_;  // observations of point p: first_[p] .. first_[p + 1]
  std::vector<Matrix6d> H_view_;
  std::vector<Vector6d> b_view_;
  std::vector<Eigen::Matrix3d> H_point_, H_inverse_;
  std::vector<Eigen::Vector3d> b_point_, step_point_;
  std::vector<Matrix63d> W_;                             // one per observation: view by point
  std::vector<Vector6d> b_observation_;                  // likewise: its share of b_view_
  int lens_ = 0;                                         // unknowns of the lens
  std::vector<Matrix26d> H_lens_view_;                   // lens by view
  std::vector<Eigen::Matrix<double, kLens, 3>> W_lens_;  // one per point: lens by point
  std::vector<LensVector> b_lens_point_;                 // likewise: its share of b_lens_
  LensMatrix H_lens_ = LensMatrix::Zero();
  LensVector b_lens_ = LensVector::Zero();
  std::vector<Matrix6d> S_views_;
  Eigen::MatrixXd S_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
  Eigen::VectorXd b_, step_camera_;
};

template <int kColumns>
Eigen::Matrix<double, kColumns, 1> BundleSystem::pull(
    std::size_t p, const Eigen::Matrix<double, Eigen::Dynamic, kColumns>& through) const {
  const Eigen::Vector3d own = H_inverse_[p] * b_point_[p];
  Eigen::Matrix<double, kColumns, 1> result = Eigen::Matrix<double, kColumns, 1>::Zero();
  for (std::size_t k = first_[p]; k < first_[p + 1]; ++k) {
    const int s = slot_[static_cast<std::size_t>(problem_.observations[k].view)];
    if (s < 0) continue;
    result.noalias() += through.template middleRows<6>(6 * s).transpose() * (b_observation_[k] - W_[k] * own);
  }
  if (lens_ > 0)
    result.noalias() += through.template bottomRows<kLens>().transpose() * (b_lens_point_[p] - W_lens_[p] * own);
  return result;
}

}  // namespace rfmvo
