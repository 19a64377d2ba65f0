// The lens's derivatives against differences; what a bundle tells of the lens, and what it cannot.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "vision/bundle_adjustment.hpp"
#include "vision/lens.hpp"

namespace rfmvo {
namespace {

constexpr double kStep = 1e-6;  // central differences: error about kStep^2 times a third derivative, below 1e-9

CameraModel camera_with(double k1) {
  CameraModel camera;
  camera.radtan = {k1, 0.03, 1e-3, -5e-4, 0.0};
  return camera;
}

TEST(Lens, DerivativeOfUnprojectionEqualsCentralDifferences) {
  for (const Eigen::Vector2d& px : {Eigen::Vector2d(20, 30), Eigen::Vector2d(600, 100), Eigen::Vector2d(320, 240)}) {
    const Eigen::Vector2d numeric =
        (unproject(camera_with(-0.1 + kStep), px) - unproject(camera_with(-0.1 - kStep), px)) / (2 * kStep);
    const CameraModel camera = camera_with(-0.1);
    EXPECT_LT((d_unproject_d_k1(camera, unproject(camera, px)) - numeric).norm(), 1e-8);
  }
}

TEST(Lens, ImageFlowIsTheMotionOfAProjectedPoint) {
  const ViewPose a{so3_exp({0.1, -0.2, 0.3}), {0.1, -0.05, 0.2}};
  const Twist twist{{0.3, -0.4, 0.2}, {0.5, 0.1, -0.2}};
  const auto at = [&](double s) {
    Vector6d step;
    step << s * twist.omega_rad_s, s * twist.v_s;
    return moved(a, step);
  };
  const Eigen::Vector3d p_V(0.3, -0.2, 1.4);
  const Eigen::Vector2d numeric = ((at(kStep) * p_V).hnormalized() - (at(-kStep) * p_V).hnormalized()) / (2 * kStep);
  EXPECT_LT((image_flow_s(a * p_V, twist) - numeric).norm(), 1e-8);
  const Twist found = twist_between(at(-kStep), at(kStep), 2 * kStep);
  EXPECT_LT((image_flow_s(a * p_V, found) - numeric).norm(), 1e-5);
}

// What `lens` makes of a pixel after one step of k1 and readout, by its own derivative and for real.
TEST(Lens, DerivativeOfTheSightLineEqualsCentralDifferences) {
  const Twist twist{{0.3, -0.4, 0.2}, {0.5, 0.1, -0.2}};
  const Eigen::Vector3d p_C(0.4, 0.3, 1.2);
  const Eigen::Vector2d px(500, 390);
  const auto line = [&](const LensVector& v) {
    const Lens lens(camera_with(v(0)), {1.0, v(1), 1.0});
    return lens.at_stamp(unproject(lens.camera(), px), px.y(), p_C, twist);
  };
  const LensVector here(-0.05, 0.02);
  const Lens lens(camera_with(here(0)), {1.0, here(1), 1.0});
  const LensJacobian J = lens.d_at_stamp(unproject(lens.camera(), px), px.y(), p_C, twist);
  for (int i = 0; i < 2; ++i) {
    const LensVector d = kStep * LensVector::Unit(i);
    const Eigen::Vector2d numeric = (line(here + d) - line(here - d)) / (2 * kStep);
    // The cross term of k1 and readout (flow of a point that moves with k1) is left out.
    EXPECT_LT((J.col(i) - numeric).norm(), 1e-6) << "column " << i;
  }
}

constexpr double kFocal_px = 500.0;

double wave(int i, double a) { return std::sin(a * i + 0.3 * a * a); }

// Points on and before a wall, seen from a turning camera that moves sideways with changing speed, through
// a lens with this k1 and readout; `spread` is the half width of the scene.
BundleProblem distorted_scene(double k1, double readout_s, double spread, const Lens& told) {
  BundleProblem bundle;
  std::vector<Twist> twists;
  for (int v = 0; v < 6; ++v) {
    const Eigen::Quaterniond R = so3_exp({0.05 * wave(v, 1.3), 0.1 * wave(v, 0.9), 0.05 * wave(v, 2.1)});
    bundle.views.push_back({{R, -(R * Eigen::Vector3d(0.06 * v, 0.03 * wave(v, 1.7), 0.03 * wave(v, 0.7)))}, v < 2});
    twists.push_back({{0.5 * wave(v, 2.3), 0.7 * wave(v, 1.1), 0.4 * wave(v, 0.8)}, {0.3 * wave(v, 1.9), 0.2, 0.1}});
  }
  CameraModel real = told.camera();
  real.radtan[0] = k1;
  for (int p = 0; p < 150; ++p) {
    bundle.points_V.emplace_back(spread * wave(p, 1.7), 0.7 * spread * wave(p, 2.9), 1.2 + 0.3 * wave(p, 0.7));
    for (int v = 0; v < 6; ++v) {
      const Eigen::Vector3d p_C = bundle.views[static_cast<std::size_t>(v)].T_C_V * bundle.points_V.back();
      const Twist& twist = twists[static_cast<std::size_t>(v)];
      Eigen::Vector2d px = project(real, p_C.hnormalized());
      for (int i = 0; i < 3; ++i) {  // the row decides when, when decides the row
        const double t = row_share(real, px.y()) * readout_s;
        px = project(real, Eigen::Vector2d(p_C.hnormalized() + t * image_flow_s(p_C, twist)));
      }
      const Eigen::Vector2d n = unproject(told.camera(), px);
      bundle.observations.push_back(
          {v, p, told.at_stamp(n, px.y(), p_C, twist), told.d_at_stamp(n, px.y(), p_C, twist)});
    }
  }
  bundle.lens = {true, LensVector::Zero(), told.expected_step(), told.information()};
  return bundle;
}

// A lens that is no longer held; what let it go weighs little.
Lens shown_lens() {
  Lens lens(CameraModel{}, {0.05, 0.0, 0.01});
  // Windows that see 0.05 and 10 ms where the calibration has 0: 8 and 5 sigmas of theirs.
  lens.learn(LensVector::Zero(), LensVector(1e5, 1.2e6).asDiagonal(), LensVector(5e3, 1.2e4));
  return lens;
}

TEST(Lens, ABundleTellsK1AndTheReadoutTime) {
  const Lens told = shown_lens();
  BundleProblem bundle = distorted_scene(-0.01, 0.005, 0.6, told);
  const BundleReport report = adjust_bundle(bundle, {kFocal_px, 1.0, 30});
  EXPECT_NEAR(bundle.lens.step(0), -0.01, 0.001);  // second order in k1, and the prior pulls a little
  EXPECT_NEAR(bundle.lens.step(1), 0.005, 0.0005);
  EXPECT_GT(report.lens_information(0, 0), 10.0 * told.information()(0, 0));
}

// One sight line per point: the point can follow whatever the lens does.
TEST(Lens, ABundleThatSeesNothingOfTheLensLeavesIt) {
  const Lens told = shown_lens();
  BundleProblem bundle = distorted_scene(-0.02, 0.005, 0.6, told);
  std::erase_if(bundle.observations, [](const BundleObservation& o) { return o.view != 0; });
  const BundleReport report = adjust_bundle(bundle, {kFocal_px, 1.0, 30});
  EXPECT_NEAR(bundle.lens.step(0), 0.0, 1e-4);
  EXPECT_NEAR(bundle.lens.step(1), 0.0, 1e-5);
  EXPECT_LT(report.lens_information(0, 0), 0.01 * told.information()(0, 0));
  EXPECT_LT(report.lens_information(1, 1), 0.01 * told.information()(1, 1));
}

TEST(Lens, IsHeldUntilAWindowContradictsTheCalibration) {
  Lens lens(CameraModel{}, {0.05, 0.0, 0.01});
  const double held = lens.information()(0, 0);
  const LensMatrix sharp = LensVector(1e6, 1e6).asDiagonal(), blurred = LensVector(1e3, 1e3).asDiagonal();
  lens.learn(LensVector::Zero(), blurred, blurred * LensVector(0.05, 0.0));  // sees much, but not clearly
  EXPECT_GE(lens.information()(0, 0), held);
  lens.learn(LensVector::Zero(), sharp, sharp * LensVector(0.003, 0.0));  // sees clearly that it is right
  EXPECT_GE(lens.information()(0, 0), held);
  lens.learn(LensVector::Zero(), sharp, sharp * LensVector(0.03, 0.0));
  EXPECT_LT(lens.information()(0, 0), 1e-3 * held);
  EXPECT_GE(lens.information()(1, 1), held);
}

// The pull is what the images want: at the answer there is none, and information^-1 pull leads there.
TEST(Lens, ABundleThatHoldsTheLensStillTellsWhatItWants) {
  const Lens told(CameraModel{}, {0.05, 0.0, 0.01});
  BundleProblem bundle = distorted_scene(-0.01, 0.005, 0.6, told);
  const BundleReport report = adjust_bundle(bundle, {kFocal_px, 100.0, 30});
  EXPECT_NEAR(bundle.lens.step(0), 0.0, 1e-9);
  const LensVector wanted = report.lens_information.inverse() * report.lens_pull;
  EXPECT_NEAR(wanted(0), -0.01, 0.003);  // one Newton step from a bent map
  EXPECT_NEAR(wanted(1), 0.005, 0.0015);
}

TEST(Lens, WhatWindowsToldIsKeptAndAHeldNumberStays) {
  Lens lens(CameraModel{}, {0.05, 0.01, 0.0});
  const LensMatrix much = LensVector(1e6, 1e6).asDiagonal();
  lens.learn(LensVector::Zero(), much, much * LensVector(-0.05, 0.0));
  const double at_first = lens.information()(0, 0);
  for (int i = 0; i < 10; ++i) lens.learn({-0.002, 0.0}, much, LensVector::Zero());
  EXPECT_NEAR(lens.camera().radtan[0], -0.02, 1e-12);
  EXPECT_EQ(lens.readout_s(), 0.01);
  EXPECT_GT(lens.expected_step()(0), 0.0);  // the mean of all that was told is behind the newest
  EXPECT_LT(lens.expected_step()(0), 0.02);
  EXPECT_GT(lens.information()(0, 0), 5.0 * at_first);
}

}  // namespace
}  // namespace rfmvo
