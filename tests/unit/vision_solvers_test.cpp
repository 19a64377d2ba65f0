// Jacobians against differences, and what the solvers must find on exact and on bad data.
#include <gtest/gtest.h>

#include <random>

#include "base/units.hpp"
#include "vision/bundle_adjustment.hpp"
#include "vision/motion_solver.hpp"
#include "vision/reprojection.hpp"
#include "vision/triangulation.hpp"
#include "vision/two_view.hpp"

namespace rfmvo {
namespace {

constexpr double kFocal_px = 500.0;

struct Scene {
  std::vector<Eigen::Vector3d> points_V;
  std::vector<ViewPose> views;
};

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / static_cast<double>(std::mt19937::max()));
}

// A sideways pass: points about 1 ahead (on one plane if flat), cameras 0.05 apart that turn a little.
Scene make_scene(int points, int views, bool flat = false) {
  std::mt19937 random(7);
  Scene scene;
  for (int i = 0; i < points; ++i) {
    const double z = flat ? 1.0 : uniform(random, 0.8, 1.6);
    scene.points_V.emplace_back(uniform(random, -0.5, 0.6), uniform(random, -0.4, 0.4), z);
  }
  for (int v = 0; v < views; ++v) {
    const Eigen::Quaterniond R = so3_exp({0.01 * v, -0.02 * v, 0.005 * v});
    const Eigen::Vector3d centre(0.05 * v, 0.004 * v * v, 0.01 * v);
    scene.views.push_back({R, -(R * centre)});
  }
  return scene;
}

Eigen::Vector2d seen(const ViewPose& T_C_V, const Eigen::Vector3d& p_V) { return (T_C_V * p_V).hnormalized(); }

double rotation_error_rad(const ViewPose& a, const ViewPose& b) { return a.R_C_V.angularDistance(b.R_C_V); }

TEST(Reprojection, PoseJacobianEqualsCentralDifferences) {
  const ViewPose T_C_V{so3_exp({0.1, -0.2, 0.3}), {0.1, -0.05, 0.2}};
  const Eigen::Vector3d p_V(0.3, -0.2, 1.4);
  const Eigen::Vector2d measured(0.1, 0.05);
  const Eigen::Vector3d p_C = T_C_V * p_V;
  const auto J = d_pose(reproject(p_C, measured, kFocal_px), p_C);
  constexpr double kStep = 1e-6;  // central differences: error about kStep^2 * third derivative (1e3 px), below 1e-8
  for (int i = 0; i < 6; ++i) {
    const Vector6d d = kStep * Vector6d::Unit(i);
    const Eigen::Vector2d numeric = (reproject(moved(T_C_V, d) * p_V, measured, kFocal_px).error_px -
                                     reproject(moved(T_C_V, -d) * p_V, measured, kFocal_px).error_px) /
                                    (2 * kStep);
    EXPECT_LT((J.col(i) - numeric).norm(), 1e-5) << "column " << i;
  }
}

TEST(Reprojection, PointJacobianEqualsCentralDifferences) {
  const Eigen::Vector3d p_C(0.3, -0.2, 1.4);
  const auto r = reproject(p_C, {0.1, 0.05}, kFocal_px);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
    const Eigen::Vector2d numeric =
        (reproject(p_C + d, {0.1, 0.05}, kFocal_px).error_px - reproject(p_C - d, {0.1, 0.05}, kFocal_px).error_px) /
        (2 * kStep);
    EXPECT_LT((r.d_camera_point.col(i) - numeric).norm(), 1e-5) << "column " << i;
  }
}

TEST(MotionSolver, FindsThePoseWithAThirdOfOutliers) {
  const Scene scene = make_scene(90, 3);
  std::mt19937 random(3);
  std::vector<MotionObservation> observations;
  for (std::size_t i = 0; i < scene.points_V.size(); ++i) {
    Eigen::Vector2d n = seen(scene.views[2], scene.points_V[i]);
    if (i % 3 == 0) n += Eigen::Vector2d(uniform(random, 0.02, 0.2), uniform(random, -0.2, -0.02));
    observations.push_back({scene.points_V[i], n});
  }
  const MotionSolution s = solve_motion(observations, scene.views[1], {kFocal_px, 0.6, 2.0});
  EXPECT_EQ(s.inliers, 60);
  EXPECT_LT(rotation_error_rad(s.T_C_V, scene.views[2]), 1e-7);
  EXPECT_LT((s.T_C_V.t_C_V - scene.views[2].t_C_V).norm(), 1e-7);
}

TEST(MotionSolver, GlobalSearchNeedsNoPrediction) {
  const Scene scene = make_scene(60, 2);
  const ViewPose truth{so3_exp({0.0, 0.9, 0.1}), {0.3, 0.1, 0.6}};
  std::vector<MotionObservation> observations;
  for (const auto& p : scene.points_V) observations.push_back({p, seen(truth, p)});
  const MotionSolution s = solve_motion_globally(observations, ViewPose{}, {kFocal_px, 0.6, 2.0});
  EXPECT_GT(s.inliers, 55);
  EXPECT_LT(rotation_error_rad(s.T_C_V, truth), 1e-6);
}

TEST(MotionSolver, CovarianceAgreesWithTheScatterOfManyTrials) {
  const Scene scene = make_scene(80, 2);
  std::mt19937 random(11);
  constexpr int kTrials = 200;
  constexpr double kSigma_px = 0.3;
  double nees = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<MotionObservation> observations;
    for (const auto& p : scene.points_V) {
      Eigen::Vector2d noise(0, 0);  // sum of 12 uniforms: unit variance, near enough normal
      for (int k = 0; k < 12; ++k) noise += Eigen::Vector2d(uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5));
      observations.push_back({p, seen(scene.views[1], p) + kSigma_px / kFocal_px * noise});
    }
    const MotionSolution s = solve_motion(observations, scene.views[0], {kFocal_px, 0.6, 2.0});
    const ViewPose error = relative(scene.views[1], s.T_C_V);
    Vector6d e;
    e << so3_log(error.R_C_V), error.t_C_V;
    nees += e.dot(s.covariance.inverse() * e) / kTrials;
  }
  // Mean of 200 chi-square variables of 6 degrees: 6 +- 4 * sqrt(12 / 200) = 5..7; Huber costs some 10 % more.
  EXPECT_GT(nees, 4.5);
  EXPECT_LT(nees, 8.0);
}

TEST(Triangulation, FindsAnExactPointAndRefusesOneWithoutParallax) {
  const Scene scene = make_scene(20, 6);
  for (const auto& p : scene.points_V) {
    std::vector<SightLine> lines;
    for (const auto& view : scene.views) lines.push_back({view, seen(view, p)});
    const auto found = triangulate(lines, rad_from_deg(1.0), kFocal_px, 1.0);
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((*found - p).norm(), 1e-9);
    EXPECT_FALSE(triangulate(lines, rad_from_deg(60.0), kFocal_px, 1.0).has_value());
  }
}

BundleProblem make_bundle(const Scene& scene) {
  BundleProblem bundle;
  for (std::size_t v = 0; v < scene.views.size(); ++v) bundle.views.push_back({scene.views[v], v < 2});
  bundle.points_V = scene.points_V;
  for (std::size_t p = 0; p < scene.points_V.size(); ++p) {
    for (std::size_t v = 0; v < scene.views.size(); ++v) {
      bundle.observations.push_back(
          {static_cast<int>(v), static_cast<int>(p), seen(scene.views[v], scene.points_V[p])});
    }
  }
  return bundle;
}

TEST(BundleAdjustment, ReturnsToTheTruthFromADisturbedStart) {
  const Scene scene = make_scene(60, 8);
  BundleProblem bundle = make_bundle(scene);
  std::mt19937 random(5);
  for (std::size_t v = 2; v < bundle.views.size(); ++v) {
    Vector6d d;
    for (int i = 0; i < 6; ++i) d(i) = uniform(random, -0.01, 0.01);
    bundle.views[v].T_C_V = moved(bundle.views[v].T_C_V, d);
  }
  for (auto& p : bundle.points_V) p *= uniform(random, 0.95, 1.05);
  const BundleReport report = adjust_bundle(bundle, {kFocal_px, 1.0, 30});
  EXPECT_LT(report.final_cost, 1e-6 * report.initial_cost);
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    EXPECT_LT(rotation_error_rad(bundle.views[v].T_C_V, scene.views[v]), 1e-4);
    EXPECT_LT((bundle.views[v].T_C_V.t_C_V - scene.views[v].t_C_V).norm(), 1e-4);
  }
}

TEST(BundleAdjustment, LeavesFixedViewsAloneAndNeverRaisesTheCost) {
  const Scene scene = make_scene(30, 5);
  BundleProblem bundle = make_bundle(scene);
  for (auto& o : bundle.observations) o.measured.x() += 0.001 * ((o.point * 7 + o.view * 3) % 5 - 2);
  const BundleReport report = adjust_bundle(bundle, {kFocal_px, 1.0, 10});
  EXPECT_LE(report.final_cost, report.initial_cost);
  EXPECT_EQ(bundle.views[0].T_C_V.t_C_V, scene.views[0].t_C_V);
  EXPECT_EQ(bundle.views[1].T_C_V.R_C_V.coeffs(), scene.views[1].R_C_V.coeffs());
}

// The path of a scene scaled by s is the path scaled by s: the error has no unit of length in it.
TEST(BundleAdjustment, ScaledSceneGivesTheScaledAnswer) {
  constexpr double kScale = 4.0;  // a power of two: scaling is exact
  Scene scene = make_scene(40, 5);
  BundleProblem small = make_bundle(scene);
  for (auto& p : small.points_V) p *= 1.02;
  BundleProblem large = small;
  for (auto& v : large.views) v.T_C_V.t_C_V *= kScale;
  for (auto& p : large.points_V) p *= kScale;
  adjust_bundle(small, {kFocal_px, 1.0, 30});
  adjust_bundle(large, {kFocal_px, 1.0, 30});
  for (std::size_t v = 0; v < small.views.size(); ++v) {
    EXPECT_LT((kScale * small.views[v].T_C_V.t_C_V - large.views[v].T_C_V.t_C_V).norm(), 1e-4);
  }
}

class TwoView : public testing::TestWithParam<bool> {};

TEST_P(TwoView, TheTruePoseIsAmongTheBestHypotheses) {
  const Scene scene = make_scene(120, 5, GetParam());
  std::vector<PointPair> pairs;
  for (const auto& p : scene.points_V) pairs.push_back({seen(scene.views[0], p), seen(scene.views[4], p)});
  for (std::size_t i = 0; i < pairs.size(); i += 6) pairs[i].second += Eigen::Vector2d(0.1, -0.05);
  const ViewPose truth = relative(scene.views[4], scene.views[0]);
  const auto hypotheses = two_view_hypotheses(pairs, kFocal_px, 2.0);
  ASSERT_FALSE(hypotheses.empty());
  double best_rad = kPi;
  for (const auto& h : hypotheses) {
    if (h.score < 0.7 * hypotheses.front().score) break;
    if (h.T_C2_C1.t_C_V.dot(truth.t_C_V.normalized()) < std::cos(rad_from_deg(3.0))) continue;
    best_rad = std::min(best_rad, rotation_error_rad(h.T_C2_C1, truth));
  }
  EXPECT_LT(deg_from_rad(best_rad), 0.5);
}

INSTANTIATE_TEST_SUITE_P(DeepAndFlat, TwoView, testing::Bool());

TEST(TwoView, RotationAloneLeavesNoResidualAndTranslationDoes) {
  const Scene scene = make_scene(80, 2);
  const ViewPose turned{so3_exp({0.02, 0.1, -0.03}), Eigen::Vector3d::Zero()};
  std::vector<PointPair> turning, passing;
  for (const auto& p : scene.points_V) {
    turning.push_back({seen(ViewPose{}, p), seen(turned, p)});
    passing.push_back({seen(scene.views[0], p), seen(scene.views[1], p)});
  }
  EXPECT_LT(rotation_only_residual_px(turning, kFocal_px), 1e-6);
  EXPECT_GT(rotation_only_residual_px(passing, kFocal_px), 1.0);
}

}  // namespace
}  // namespace rfmvo
