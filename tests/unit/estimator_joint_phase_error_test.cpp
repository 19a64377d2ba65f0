#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "estimator/phase_error_model.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

constexpr double kLength_m = 0.058;

TEST(StructuredCorrelation, IsOneAtRestAndFallsAllTheWay) {
  EXPECT_EQ(matern32(0.0, kLength_m), 1.0);
  double before = 1.0;
  for (int mm = 1; mm < 500; ++mm) {
    const double now = matern32(0.001 * mm, kLength_m);
    EXPECT_LT(now, before);
    EXPECT_GT(now, 0.0);
    EXPECT_EQ(now, matern32(-0.001 * mm, kLength_m));
    before = now;
  }
}

TEST(StructuredCorrelation, RunsThroughWhatWasMeasured) {
  // DESIGN 2.7; the header claims 0.08.
  for (const auto& [distance_m, measured] :
       {std::pair{0.02, 0.94}, {0.04, 0.85}, {0.08, 0.61}, {0.12, 0.37}, {0.16, 0.16}})
    EXPECT_NEAR(matern32(distance_m, kLength_m), measured, 0.1) << distance_m;
}

TEST(StructuredCorrelation, IsFlatAtTheOrigin) {
  // Matern 3/2 is once differentiable: 1 - a^2 / 2 to first order, where exp(-a) loses a.
  EXPECT_NEAR(matern32(0.01 * kLength_m, kLength_m), 1.0 - 0.5e-4, 1e-6);
}

TEST(StructuredCorrelation, OfLongEchoesLiesBetweenItsTwoParts) {
  for (const double distance_m : {0.01, 0.05, 0.1, 0.3}) {
    const double near = matern32(distance_m, kLength_m), far = matern32(distance_m, kLongLength_m);
    EXPECT_EQ(structured_correlation(distance_m, {kLength_m, 0.0, 0.0}), near);
    EXPECT_NEAR(structured_correlation(distance_m, {kLength_m, 0.0, 1.0}), far, 1e-15);
    EXPECT_NEAR(structured_correlation(distance_m, {kLength_m, 0.0, 0.25}), 0.75 * near + 0.25 * far, 1e-15);
  }
}

TEST(RelativeStrength, IsTheFieldLostToThePowerOfTheExponent) {
  // 20 dB of power there and back are a factor of sqrt(10) one way.
  EXPECT_EQ(relative_strength(20.0, {kLength_m, 0.0}), 1.0);
  EXPECT_NEAR(relative_strength(20.0, {kLength_m, 1.0}), std::sqrt(10.0), 1e-12);
  EXPECT_NEAR(relative_strength(20.0, {kLength_m, 0.5}), std::sqrt(std::sqrt(10.0)), 1e-12);
  EXPECT_EQ(relative_strength(0.0, {kLength_m, 1.0}), 1.0);
}

TEST(WhiteSigma, GrowsAsTheSignalWeakensWithoutSteps) {
  double before = white_sigma_rad(-20.0);
  EXPECT_DOUBLE_EQ(before, 0.022);
  for (double dbm = -20.0; dbm >= -90.0; dbm -= 0.1) {
    const double now = white_sigma_rad(dbm);
    EXPECT_GE(now, before - 1e-12);
    EXPECT_LT(now - before, 0.003);  // 0.14 rad over 7 dB: 0.002 per tenth
    before = now;
  }
  EXPECT_DOUBLE_EQ(white_sigma_rad(-50.0), 0.06);
  EXPECT_DOUBLE_EQ(white_sigma_rad(-80.0), 0.2);
}

struct Sample {
  std::vector<Eigen::Vector3d> positions;
  Eigen::Matrix4d distances = Eigen::Matrix4d::Zero();
};

Sample random_sample(std::mt19937& random) {
  Sample s;
  for (int i = 0; i < 4; ++i) s.positions.push_back(joint_scene::random_vector(random, 0.1));
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      s.distances(i, j) = (s.positions[static_cast<std::size_t>(i)] - s.positions[static_cast<std::size_t>(j)]).norm();
  return s;
}

TEST(Conditioning, IsTheExactGaussianConditional) {
  std::mt19937 random(21);
  for (int n = 0; n < 50; ++n) {
    const Sample s = random_sample(random);
    const Eigen::Vector4d white(0.01, 0.0025, 0.04, 0.0004);
    Eigen::MatrixXd K = joint_scene::error_covariance(s.positions, 0.4, kLength_m, 0.0);
    K.diagonal() += white;
    for (Eigen::Index count = 1; count <= 3; ++count) {
      // From the inverse of the joint covariance: variance 1 / P00, weights -P0i / P00.
      const Eigen::MatrixXd P = K.topLeftCorner(count + 1, count + 1).inverse();
      const Conditioning c =
          condition_on_neighbours(static_cast<std::size_t>(count), s.distances, white, 0.4, kLength_m);
      // K's condition number is at most 4 * 0.16 / 4e-4 = 1600.
      EXPECT_NEAR(c.variance_rad2, 1.0 / P(0, 0), 1e-10);
      for (Eigen::Index i = 1; i <= count; ++i)
        EXPECT_NEAR(c.weights[static_cast<std::size_t>(i - 1)], -P(0, i) / P(0, 0), 1e-10);
    }
  }
}

TEST(Conditioning, NeverKnowsLessThanThePriorNorMoreThanTheWhiteNoiseLeaves) {
  std::mt19937 random(22);
  for (int n = 0; n < 200; ++n) {
    const Sample s = random_sample(random);
    const Eigen::Vector4d white = Eigen::Vector4d::Constant(0.0005);
    double before = 0.16 + 0.0005;
    for (std::size_t count = 0; count <= 3; ++count) {
      const Conditioning c = condition_on_neighbours(count, s.distances, white, 0.4, kLength_m);
      EXPECT_LE(c.variance_rad2, before + 1e-12);  // another neighbour never hurts
      EXPECT_GE(c.variance_rad2, 0.0005);
      before = c.variance_rad2;
    }
  }
}

TEST(Conditioning, OnReadsAtTheSamePlaceStaysFinite) {
  // Standstill: the structured errors are one; only white noise keeps the matrix definite.
  const Conditioning c =
      condition_on_neighbours(3, Eigen::Matrix4d::Zero(), Eigen::Vector4d::Constant(4.8e-4), 0.8, kLength_m);
  EXPECT_NEAR(c.variance_rad2, 4.8e-4 * 4.0 / 3.0, 1e-6);  // mean of three noisy looks, and this one's own noise
  for (const double weight : c.weights) EXPECT_NEAR(weight, 1.0 / 3.0, 1e-3);
}

TEST(Conditioning, OnFarReadsChangesNothing) {
  Eigen::Matrix4d far = Eigen::Matrix4d::Constant(10.0);
  far.diagonal().setZero();
  const Conditioning c = condition_on_neighbours(3, far, Eigen::Vector4d::Constant(0.01), 0.5, kLength_m);
  EXPECT_NEAR(c.variance_rad2, 0.26, 1e-12);
  for (const double weight : c.weights) EXPECT_NEAR(weight, 0.0, 1e-12);
}

}  // namespace
}  // namespace rfmvo
