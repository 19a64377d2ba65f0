// The pose of one camera against a map that stays fixed ("motion-only" adjustment).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "vision/view_pose.hpp"

namespace rfmvo {

struct MotionObservation {
  Eigen::Vector3d p_V;
  Eigen::Vector2d measured;  // normalised image plane, undistorted
  double scale = 1.0;        // image_scale() there
};

struct MotionOptions {
  double focal_px = 500.0;
  double huber_px = 0.6;  // VISION design: per-frame motion, 0.6 px
  double gate_px = 2.0;   // an error above this is an outlier
};

struct MotionSolution {
  ViewPose T_C_V;
  int inliers = 0;
  double rms_px = 0.0;                     // of the inliers
  std::vector<double> error_px;            // one per observation; behind the camera: infinity
  Matrix6d covariance = Matrix6d::Zero();  // of the step of moved(), from the inliers' own scatter; zero if < 6 inliers
};

// Levenberg-Marquardt with Huber weights, twice: with all observations, then with those inside the gate.
[[nodiscard]] MotionSolution solve_motion(std::span<const MotionObservation> observations, const ViewPose& initial,
                                          const MotionOptions& options);

// From scratch: P3P inside RANSAC (fixed seed), then solve_motion. For use when the prediction failed.
[[nodiscard]] MotionSolution solve_motion_globally(std::span<const MotionObservation> observations,
                                                   const ViewPose& fallback, const MotionOptions& options);

}  // namespace rfmvo
