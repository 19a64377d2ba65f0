#include <gtest/gtest.h>

#include <cmath>

#include "estimator/distance_steps.hpp"
#include "estimator/joint_optimization.hpp"
#include "unit/estimator_paper_scene.hpp"

namespace rfmvo {
namespace {

using paper_scene::kPi;
using paper_scene::kWavelength_m;

const Eigen::Vector3d kTag_m(1.0, 0.4, 1.8);  // z: the boresight of D = V here
constexpr double kGamma = 1.7;
constexpr double kDeg = kPi / 180.0;

AntennaTerm term_at(const Eigen::Vector3d& lever_m, double offset_rad, double noise_rad = 0.0) {
  auto path = paper_scene::weave(60, 1.0);
  for (auto& p : path) p += lever_m;
  auto phases = paper_scene::tag_phases(path, kTag_m, offset_rad);
  for (std::size_t i = 0; i < phases.size(); ++i) phases[i] += noise_rad * paper_scene::wobble(static_cast<int>(i));
  AntennaTerm term;
  term.array = paper_scene::array_of(path, phases, kGamma);
  term.array.lever_V_m.colwise() += lever_m + paper_scene::weave(1, 1.0)[0];
  // Exact directions in place of the averages over other arrays.
  for (const auto& p : path) {
    AngleSums sums;
    for (int repeat = 0; repeat < 20; ++repeat)
      sums.add(angles_of((kTag_m - p).normalized()), Eigen::Quaterniond::Identity());
    term.others.push_back(sums);
  }
  term.angles = angles_of((kTag_m - path[path.size() / 2]).normalized());
  return term;
}

JointOptions options() {
  JointOptions o;
  o.refine_step_rad = kDeg;
  o.refine_range_rad = 20 * kDeg;
  return o;
}

TEST(JointOptimization, FindsTheTagAndTheScaleWithoutNoise) {
  const std::vector<AntennaTerm> terms{term_at({0, 0, 0}, 0.4), term_at({0, 0.5, 0}, 2.2)};
  for (const bool fix : {false, true}) {
    JointOptions o = options();
    o.fix_cycles = fix;
    o.fix_sphere_average = fix;
    const ArraySolution s = joint_optimization(terms, 1.15 * kGamma, o);
    ASSERT_TRUE(s.found);
    EXPECT_NEAR((s.p_X_m - kTag_m).norm(), 0.0, 1e-4);  // the outer loop stops below 1e-4 m
    EXPECT_NEAR(s.gamma, kGamma, 1e-4);
    EXPECT_LT(s.sigma_m, 1e-6);
  }
}

TEST(JointOptimization, ErrsByItsOwnCovarianceUnderWhiteNoise) {
  const std::vector<AntennaTerm> terms{term_at({0, 0, 0}, 0.4, 0.1), term_at({0, 0.5, 0}, 2.2, 0.1)};
  const ArraySolution s = joint_optimization(terms, kGamma, options());
  ASSERT_TRUE(s.found);
  Eigen::Vector4d error;
  error << s.p_X_m - kTag_m, s.gamma - kGamma;
  // 23.5: 1e-4 tail of chi-square with 4 degrees of freedom.
  EXPECT_LT(error.dot(s.covariance.ldlt().solve(error)), 23.5);
  EXPECT_TRUE(s.covariance.allFinite());
}

TEST(JointOptimization, SaysNotFoundForParallelLines) {
  AntennaTerm term = term_at({0, 0, 0}, 0.4);
  for (AngleSums& sums : term.others) sums = AngleSums();
  EXPECT_FALSE(joint_optimization({&term, 1}, kGamma, options()).found);
}

TEST(DistanceSteps, SumsAreThoseOfTheResidualsOneByOne) {
  std::vector<AntennaTerm> terms{term_at({0, 0, 0}, 0.4), term_at({0.1, 0.5, -0.2}, 2.2)};
  terms[0].array.usable(58) = terms[1].array.usable(0) = terms[1].array.usable(20) = false;
  Eigen::VectorXd measured(2 * 59 - 3);
  for (Eigen::Index i = 0; i < measured.size(); ++i) measured(i) = 0.05 * paper_scene::wobble(static_cast<int>(i));
  const Eigen::Vector3d p(0.7, 0.2, 1.5);
  const DistanceResiduals single = distance_residuals(terms, measured, p, 1.4);
  const AntennaArray* arrays[] = {&terms[0].array, &terms[1].array};
  DistanceSteps steps(arrays, measured);
  const double cost = steps.cost_at(p, 1.4);
  const NormalEquations sums = steps.normal_equations();
  // Rounding of sums of 115 numbers below 1.
  EXPECT_LT((sums.matrix - single.jacobian.transpose() * single.jacobian).norm(), 1e-13);
  EXPECT_LT((sums.gradient - single.jacobian.transpose() * single.r_m).norm(), 1e-13);
  EXPECT_NEAR(cost, single.r_m.squaredNorm(), 1e-13);
}

TEST(DistanceResiduals, JacobianAgreesWithNumericDifferences) {
  const std::vector<AntennaTerm> terms{term_at({0, 0, 0}, 0.4), term_at({0.1, 0.5, -0.2}, 2.2)};
  const Eigen::VectorXd measured = Eigen::VectorXd::Zero(2 * 59);
  const Eigen::Vector3d p(0.7, 0.2, 1.5);
  const DistanceResiduals at = distance_residuals(terms, measured, p, 1.4);
  constexpr double kStep = 1e-6;
  for (int c = 0; c < 4; ++c) {
    Eigen::Vector4d h = Eigen::Vector4d::Zero();
    h(c) = kStep;
    const auto plus = distance_residuals(terms, measured, p + h.head<3>(), 1.4 + h(3));
    const auto minus = distance_residuals(terms, measured, p - h.head<3>(), 1.4 - h(3));
    const Eigen::VectorXd numeric = (plus.r_m - minus.r_m) / (2 * kStep);
    // Rounding: 2e-16 m / 1e-6; truncation: third derivative ~ 1 times 1e-12.
    EXPECT_LT((numeric - at.jacobian.col(c)).cwiseAbs().maxCoeff(), 1e-8) << c;
  }
}

TEST(CycleStep, IsRightForStepsBelowAQuarterWavelength) {
  for (int i = 0; i < 1000; ++i) {
    const double step_m = 0.2499 * kWavelength_m;
    const double radial_m = step_m * paper_scene::wobble(i);
    const double before = paper_scene::phase_rad(2.0 + 0.001 * i, 0.0);
    const double after = paper_scene::phase_rad(2.0 + 0.001 * i + radial_m, 0.0);
    const double cycle = cycle_step_by_length_rad(after - before, step_m, kWavelength_m);
    EXPECT_NEAR((after - before + cycle) * kWavelength_m / (4 * kPi), radial_m, 1e-9);
  }
}

TEST(CycleStep, IsWrongForAboutHalfOfTheStepsUpToHalfAWavelength) {
  // Eq. (22) forces |radial change| > lambda/4. Steps in (lambda/4, lambda/2], the angle to the tag even over
  // the circle.
  int wrong = 0;
  constexpr int kTrials = 20000;
  for (int i = 0; i < kTrials; ++i) {
    const double step_m = kWavelength_m * (0.375 + 0.125 * paper_scene::wobble(i));
    const double radial_m = step_m * std::cos(kPi * (i + 0.5) / kTrials);
    const double before = paper_scene::phase_rad(2.0, 0.0), after = paper_scene::phase_rad(2.0 + radial_m, 0.0);
    const double cycle = cycle_step_by_length_rad(after - before, step_m, kWavelength_m);
    if (std::abs((after - before + cycle) * kWavelength_m / (4 * kPi) - radial_m) > 1e-6) ++wrong;
  }
  EXPECT_NEAR(static_cast<double>(wrong) / kTrials, 0.48, 0.06);
}

}  // namespace
}  // namespace rfmvo
