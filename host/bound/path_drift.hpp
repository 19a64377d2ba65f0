// What a monocular odometry does not know of its own path: the walks of its scale and heading, as increments
// at knots along the way. At the truth the model is linear in them:
//   shift(t) = sum over knots j passed before t of (e_j + theta_j x) (X(t) - X_j),   turn(t) = sum of theta_j
// which is X_V = integral of (1 + e) exp(theta) dX, the simulator's drift, to first order.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "bound/world.hpp"

namespace rfmvo::bound {

class PathDrift {
 public:
  PathDrift(const World& world, double knot_spacing_m);

  // One per unknown: the prior's 1 sigma. Per knot e, then theta (3); last, the bias of the turn.
  [[nodiscard]] const Eigen::VectorXd& sigmas() const { return sigmas_; }
  // Rows: shift (3, m), turn (3, rad), in S.
  [[nodiscard]] Eigen::Matrix<double, 6, Eigen::Dynamic> at(double t_s) const;
  [[nodiscard]] double travelled_m(double t_s) const;  // length of the camera's way

 private:
  struct Frame {
    double t_s, arc_m;
    Eigen::Vector3d p_S_C_m, bias_turn, bias_shift;  // of a bias of 1 rad/m
  };
  struct Knot {
    double arc_m;
    Eigen::Vector3d p_S_C_m;
  };
  void follow(const World& world);
  void place_knots(double spacing_m, const simulate::DriftClass& drift);
  [[nodiscard]] Frame frame_at(double t_s) const;

  std::function<Rigid3(double)> T_S_C_;
  std::vector<Frame> frames_;
  std::vector<Knot> knots_;
  Eigen::VectorXd sigmas_;
};

}  // namespace rfmvo::bound
