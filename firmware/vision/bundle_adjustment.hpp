// Bundle adjustment: poses and points together, by Levenberg-Marquardt on the Schur complement.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "vision/lens.hpp"
#include "vision/view_pose.hpp"

namespace rfmvo {

struct BundleView {
  ViewPose T_C_V;
  bool fixed = false;
};

struct BundleObservation {
  int view = 0;
  int point = 0;
  Eigen::Vector2d measured;                    // normalised image plane, undistorted
  LensJacobian d_lens = LensJacobian::Zero();  // d measured / d lens
  double scale = 1.0;                          // image_scale() there
};

// What all views share: a step of the lens from where `measured` was computed.
struct BundleLens {
  bool free = false;
  LensVector step = LensVector::Zero();
  LensVector expected = LensVector::Zero();         // of the step
  LensMatrix information = LensMatrix::Identity();  // of `expected`, px^2
};

// Observations are sorted by point. At least one view should be fixed; a freedom that nothing holds
// (the scale, say) is held by the damping alone.
struct BundleProblem {
  std::vector<BundleView> views;
  std::vector<Eigen::Vector3d> points_V;
  std::vector<BundleObservation> observations;
  BundleLens lens;
};

struct BundleOptions {
  double focal_px = 500.0;
  double huber_px = 1.0;
  int max_iterations = 6;
};

struct BundleReport {
  double initial_cost = 0.0;  // sum of Huber costs, px^2
  double final_cost = 0.0;
  int iterations = 0;
  // Of the images alone, where the adjustment ended: information (px^2), and information times the step they want.
  LensMatrix lens_information = LensMatrix::Zero();
  LensVector lens_pull = LensVector::Zero();
};

BundleReport adjust_bundle(BundleProblem& problem, const BundleOptions& options);

}  // namespace rfmvo
