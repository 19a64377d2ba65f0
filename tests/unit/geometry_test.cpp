#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/camera_model.hpp"
#include "geometry/rigid.hpp"

namespace rfmvo {
namespace {

constexpr double kPi = 3.14159265358979323846;
// A few hundred roundings of numbers of size 10.
constexpr double kRounding = 1e-12;

Eigen::Vector3d random_vector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

Rigid3 random_motion(std::mt19937& random) {
  const Eigen::Vector3d turn = random_vector(random, 1.8), t = random_vector(random, 5.0);
  return {so3_exp(turn), t};
}

void expect_same(const Rigid3& a, const Rigid3& b) {
  EXPECT_NEAR(a.R.angularDistance(b.R), 0.0, 1e-7);  // acos loses half of the digits near 1
  EXPECT_NEAR((a.R.toRotationMatrix() - b.R.toRotationMatrix()).norm(), 0.0, kRounding);
  EXPECT_NEAR((a.t - b.t).norm(), 0.0, kRounding);
}

TEST(Rotation, LogUndoesExpUpToHalfATurn) {
  std::mt19937 random(1);
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-7, 2e-6, 1e-3, 0.5, 2.0, 3.1, kPi - 1e-9})
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d omega = angle * random_vector(random, 1.0).normalized();
      EXPECT_NEAR((so3_log(so3_exp(omega)) - omega).norm(), 0.0, 1e-14 + 1e-14 * angle) << angle;
    }
}

TEST(Rotation, ExpUndoesLogAndTheLogIsAtMostHalfATurn) {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Quaterniond R = so3_exp(random_vector(random, 6.0));
    const Eigen::Vector3d log = so3_log(R);
    EXPECT_LE(log.norm(), kPi + kRounding);
    EXPECT_NEAR((so3_exp(log).toRotationMatrix() - R.toRotationMatrix()).norm(), 0.0, kRounding);
  }
}

TEST(Rotation, ExpAgreesWithAxisAndAngle) {
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d axis = random_vector(random, 1.0).normalized();
    const double angle = 0.06 * i;
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_NEAR((so3_exp(angle * axis).toRotationMatrix() - expected).norm(), 0.0, kRounding);
  }
}

TEST(Rotation, OppositeQuaternionsHaveOneLog) {
  std::mt19937 random(4);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Quaterniond R = so3_exp(random_vector(random, 1.7));
    EXPECT_NEAR((so3_log(R) - so3_log(Eigen::Quaterniond(-R.coeffs()))).norm(), 0.0, kRounding);
  }
}

TEST(Rotation, SkewIsTheCrossProduct) {
  std::mt19937 random(5);
  const Eigen::Vector3d a = random_vector(random, 2.0), b = random_vector(random, 2.0);
  EXPECT_NEAR((skew(a) * b - a.cross(b)).norm(), 0.0, kRounding);
  EXPECT_EQ(skew(a), -skew(a).transpose());
}

TEST(Rigid3, IsAGroupThatActsOnPoints) {
  std::mt19937 random(6);
  for (int i = 0; i < 50; ++i) {
    const Rigid3 a = random_motion(random), b = random_motion(random), c = random_motion(random);
    const Eigen::Vector3d p = random_vector(random, 5.0);
    expect_same((a * b) * c, a * (b * c));
    expect_same(a * Rigid3{}, a);
    expect_same(Rigid3{} * a, a);
    expect_same(a * a.inverse(), Rigid3{});
    expect_same(a.inverse() * a, Rigid3{});
    EXPECT_NEAR(((a * b) * p - a * (b * p)).norm(), 0.0, kRounding);
  }
}

TEST(Interpolation, MeetsBothEnds) {
  std::mt19937 random(7);
  for (int i = 0; i < 50; ++i) {
    const Rigid3 a = random_motion(random), b = random_motion(random);
    expect_same(interpolate(a, b, 0.0), a);
    expect_same(interpolate(a, b, 1.0), b);
  }
}

TEST(Interpolation, MovesAndTurnsAtConstantVelocity) {
  std::mt19937 random(8);
  for (int i = 0; i < 20; ++i) {
    const UnscaledPose a{so3_exp(random_vector(random, 1.5)), random_vector(random, 2.0)};
    const UnscaledPose b{a.R_V_C * so3_exp(random_vector(random, 1.0)), random_vector(random, 2.0)};
    const Eigen::Vector3d turn = so3_log(a.R_V_C.conjugate() * b.R_V_C) / 10.0, step = (b.p_V_C - a.p_V_C) / 10.0;
    for (int k = 0; k < 10; ++k) {
      const UnscaledPose p = interpolate(a, b, 0.1 * k), q = interpolate(a, b, 0.1 * (k + 1));
      EXPECT_NEAR((so3_log(p.R_V_C.conjugate() * q.R_V_C) - turn).norm(), 0.0, kRounding);
      EXPECT_NEAR((q.p_V_C - p.p_V_C - step).norm(), 0.0, kRounding);
    }
  }
}

TEST(Interpolation, OfMetricAndUnscaledPosesIsTheSame) {
  std::mt19937 random(9);
  const Rigid3 a = random_motion(random), b = random_motion(random);
  const UnscaledPose u = interpolate(UnscaledPose{a.R, a.t}, UnscaledPose{b.R, b.t}, 0.3);
  expect_same(interpolate(a, b, 0.3), {u.R_V_C, u.p_V_C});
}

// Largest |unproject(project(p)) - p| over the image of the default camera.
double round_trip_error(const CameraModel& camera) {
  double worst = 0.0;
  for (int v = 0; v < camera.height_px; v += 20)
    for (int u = 0; u < camera.width_px; u += 20) {
      // The ideal pixel (u, v); with barrel distortion all of these land inside the image.
      const Eigen::Vector2d p((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px);
      worst = std::max(worst, (unproject(camera, project(camera, p)) - p).norm());
    }
  return worst;
}

TEST(CameraModel, UnprojectUndoesProjectWithinTheHeadersBound) {
  EXPECT_LT(round_trip_error({}), 1e-15);
  EXPECT_LT(round_trip_error({.radtan = {-0.20, 0.05, 1e-3, -5e-4, 0.01}}), 1e-9);
  EXPECT_LT(round_trip_error({.radtan = {0.20, -0.05, -1e-3, 5e-4, 0.01}}), 1e-9);
}

TEST(CameraModel, UnprojectKeepsTheHeadersBoundToTheCornersForStrongDistortion) {
  // camera_model.hpp promises 1e-9 for |k1| < 0.4.
  EXPECT_LT(round_trip_error({.radtan = {-0.35, 0, 0, 0, 0}}), 1e-9);
  EXPECT_LT(round_trip_error({.radtan = {0.39, 0, 0, 0, 0}}), 1e-9);
}

const CameraModel kFisheye{.fx_px = 280,
                           .fy_px = 282,
                           .cx_px = 320,
                           .cy_px = 240,
                           .distortion = Distortion::kEquidistant,
                           .equidistant = {-0.03, 0.01, -0.008, 0.002}};

TEST(CameraModel, AFisheyeLensUnprojectsWhatItProjects) {
  for (double angle = 0.0; angle < 1.35; angle += 0.05) {
    for (double around = 0.0; around < 6.2; around += 0.7) {
      const Eigen::Vector2d p = std::tan(angle) * Eigen::Vector2d(std::cos(around), std::sin(around));
      // At the angle a, an error of the angle is 1 / cos^2(a) as large on the normalised plane: 20 at 1.35 rad.
      EXPECT_LT((unproject(kFisheye, project(kFisheye, p)) - p).norm(), 1e-9) << angle;
    }
  }
}

// OpenCV 4.6 manual, module fisheye: theta_d = theta (1 + k1 theta^2 + ..), by hand at 45 degrees along x.
TEST(CameraModel, AFisheyeLensDistortsAsWrittenInTheManual) {
  const double a = 0.78539816339744831, a2 = a * a;
  const double radius = a * (1.0 - 0.03 * a2 + 0.01 * a2 * a2 - 0.008 * a2 * a2 * a2 + 0.002 * a2 * a2 * a2 * a2);
  EXPECT_NEAR((project(kFisheye, {1.0, 0.0}) - Eigen::Vector2d(320 + 280 * radius, 240)).norm(), 0.0, 1e-10);
}

TEST(CameraModel, DerivativesOfTheDistortionEqualCentralDifferences) {
  CameraModel radtan{.radtan = {-0.2, 0.05, 1e-3, -5e-4, 0.01}};
  constexpr double kStep = 1e-6;  // error about kStep^2 times the third derivative, below 1e-10
  for (CameraModel camera : {radtan, kFisheye}) {
    const auto distorted = [&camera](const Eigen::Vector2d& p) -> Eigen::Vector2d {
      const Eigen::Vector2d px = project(camera, p);
      return {(px.x() - camera.cx_px) / camera.fx_px, (px.y() - camera.cy_px) / camera.fy_px};
    };
    const Eigen::Vector2d p(0.5, -0.3), dx(kStep, 0), dy(0, kStep);
    Eigen::Matrix2d J;
    J.col(0) = (distorted(p + dx) - distorted(p - dx)) / (2 * kStep);
    J.col(1) = (distorted(p + dy) - distorted(p - dy)) / (2 * kStep);
    EXPECT_LT((distort_jacobian(camera, p) - J).norm(), 1e-8);
    const Eigen::Vector2d by_k1 = distort_d_k1(camera, p);
    const double k1 = k1_of(camera);
    set_k1(camera, k1 + kStep);
    const Eigen::Vector2d above = distorted(p);
    set_k1(camera, k1 - kStep);
    EXPECT_LT((by_k1 - (above - distorted(p)) / (2 * kStep)).norm(), 1e-8);
  }
}

TEST(CameraModel, AFisheyeImageShrinksTowardsTheEdge) {
  EXPECT_NEAR(image_scale(kFisheye, {0.0, 0.0}), 1.0, 1e-12);
  EXPECT_LT(image_scale(kFisheye, {1.5, 0.0}), 0.5);
  EXPECT_EQ(image_scale(CameraModel{.radtan = {-0.2, 0, 0, 0, 0}}, {0.5, 0.5}), 1.0);
}

TEST(CameraModel, WithoutDistortionIsAPinhole) {
  const CameraModel camera{.fx_px = 600, .fy_px = 610, .cx_px = 300, .cy_px = 200};
  EXPECT_EQ(project(camera, {0.0, 0.0}), Eigen::Vector2d(300, 200));
  EXPECT_NEAR((project(camera, {0.5, -0.25}) - Eigen::Vector2d(600, 47.5)).norm(), 0.0, kRounding);
}

TEST(CameraModel, DistortsAsWrittenInTheManual) {
  // x (1 + k1 r2 + k2 r4 + k3 r6) + 2 p1 x y + p2 (r2 + 2 x2), by hand for x = 0.3, y = -0.4: r2 = 0.25
  const CameraModel camera{.fx_px = 1, .fy_px = 1, .cx_px = 0, .cy_px = 0, .radtan = {0.1, 0.2, 0.01, 0.02, 0.4}};
  const double radial = 1.0 + 0.025 + 0.0125 + 0.00625;
  const Eigen::Vector2d expected(0.3 * radial + 0.01 * -0.24 + 0.02 * (0.25 + 0.18),
                                 -0.4 * radial + 0.01 * (0.25 + 0.32) + 0.02 * -0.24);
  EXPECT_NEAR((project(camera, {0.3, -0.4}) - expected).norm(), 0.0, kRounding);
}

}  // namespace
}  // namespace rfmvo
