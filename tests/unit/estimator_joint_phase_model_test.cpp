#include <gtest/gtest.h>

#include "estimator/phase_model.hpp"
#include "unit/estimator_joint_scene.hpp"

namespace rfmvo {
namespace {

using joint_scene::random_rotation;
using joint_scene::random_vector;
using joint_scene::slope;

struct Case {
  ReadGeometry geometry;
  ReadStates states;
};

Case random_case(std::mt19937& random, double time_offset_s, double rotation_correction_rad) {
  Case c;
  c.geometry.n_W = random_vector(random, 2.0);
  c.geometry.velocity_W = random_vector(random, 1.0);
  c.geometry.R_W_C = random_rotation(random).toRotationMatrix();
  c.geometry.angular_velocity_C = random_vector(random, 1.0);
  c.geometry.wavenumber_rad_m = joint_scene::wavenumber_rad_m(921.5e6);
  c.geometry.frequency_term_rad_m = joint_scene::frequency_term_rad_m(921.5e6);
  c.states.log_scale = 0.4;
  c.states.time_offset_s = time_offset_s;
  c.states.port_offset_rad = 0.3;
  c.states.electrical_length_m = 7.0;
  c.states.lever_arm_C = random_vector(random, 0.4);
  c.states.path_correction_W = random_vector(random, 0.1);
  c.states.rotation_correction_W = random_vector(random, rotation_correction_rad);
  c.states.p_W_X = random_vector(random, 4.0);
  c.states.tag_offset_rad = -1.0;
  return c;
}

double phase_of(const Case& c) { return predict_phase(c.geometry, c.states).phase_rad; }

// d phase / d one state, by central differences.
double numeric(Case c, const std::function<double&(ReadStates&)>& state) {
  double& x = state(c.states);
  const double at = x;
  return slope(
      [&](double h) {
        x = at + h;
        return phase_of(c);
      },
      1e-5);
}

// Central differences with h = 1e-5: rounding 1e-16 * 150 rad / 1e-5 = 2e-9; third derivatives of the distance times
// the wavenumber (40 rad/m) and h^2 / 6: 1e-9 times at most some 10.
constexpr double kNumeric = 2e-7;

void expect_jacobian_is_numeric(const Case& c) {
  const PhaseJacobian j = predict_phase(c.geometry, c.states).jacobian;
  EXPECT_NEAR(j.log_scale, numeric(c, [](ReadStates& s) -> double& { return s.log_scale; }), kNumeric);
  EXPECT_NEAR(j.electrical_length, numeric(c, [](ReadStates& s) -> double& { return s.electrical_length_m; }),
              kNumeric);
  EXPECT_NEAR(1.0, numeric(c, [](ReadStates& s) -> double& { return s.port_offset_rad; }), kNumeric);
  EXPECT_NEAR(1.0, numeric(c, [](ReadStates& s) -> double& { return s.tag_offset_rad; }), kNumeric);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(j.lever_arm[i], numeric(c, [i](ReadStates& s) -> double& { return s.lever_arm_C[i]; }), kNumeric);
    EXPECT_NEAR(j.path_correction[i], numeric(c, [i](ReadStates& s) -> double& { return s.path_correction_W[i]; }),
                kNumeric);
    EXPECT_NEAR(j.tag_position[i], numeric(c, [i](ReadStates& s) -> double& { return s.p_W_X[i]; }), kNumeric);
  }
}

TEST(PhaseModel, JacobianEqualsTheNumericDerivative) {
  std::mt19937 random(11);
  for (int i = 0; i < 30; ++i) expect_jacobian_is_numeric(random_case(random, 0.02, 0.0));
  // All but the rotation correction's own column stay exact when there is one.
  for (int i = 0; i < 30; ++i) expect_jacobian_is_numeric(random_case(random, 0.02, 0.1));
}

TEST(PhaseModel, JacobianOfTheRotationCorrectionIsExactWhereThereIsNone) {
  std::mt19937 random(12);
  for (int n = 0; n < 30; ++n) {
    const Case c = random_case(random, 0.02, 0.0);
    const PhaseJacobian j = predict_phase(c.geometry, c.states).jacobian;
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(j.rotation_correction[i],
                  numeric(c, [i](ReadStates& s) -> double& { return s.rotation_correction_W[i]; }), kNumeric);
  }
}

TEST(PhaseModel, JacobianOfTheTimeOffsetEqualsTheNumericDerivative) {
  std::mt19937 random(13);
  for (int n = 0; n < 30; ++n)
    for (const double offset_s : {0.0, 0.02, -0.3}) {
      const Case c = random_case(random, offset_s, 0.05);
      EXPECT_NEAR(predict_phase(c.geometry, c.states).jacobian.time_offset,
                  numeric(c, [](ReadStates& s) -> double& { return s.time_offset_s; }), kNumeric)
          << offset_s;
    }
}

TEST(PhaseModel, ARigidMotionOfTheWholeWorldChangesNothing) {
  std::mt19937 random(14);
  for (int n = 0; n < 30; ++n) {
    const Case c = random_case(random, 0.02, 0.1);
    const Eigen::Matrix3d R = random_rotation(random).toRotationMatrix();
    const Eigen::Vector3d t = random_vector(random, 3.0);
    Case moved = c;
    moved.geometry.n_W = R * c.geometry.n_W;
    moved.geometry.velocity_W = R * c.geometry.velocity_W;
    moved.geometry.R_W_C = R * c.geometry.R_W_C;
    moved.states.path_correction_W = R * c.states.path_correction_W + t;
    moved.states.rotation_correction_W = R * c.states.rotation_correction_W;
    moved.states.p_W_X = R * c.states.p_W_X + t;
    EXPECT_NEAR(phase_of(moved), phase_of(c), 1e-11);  // some 200 rad to 1e-14
    EXPECT_NEAR(
        (antenna_position(moved.geometry, moved.states) - R * antenna_position(c.geometry, c.states) - t).norm(), 0.0,
        1e-12);
  }
}

TEST(PhaseModel, DoubleTheFrequencyIsDoubleTheDistanceTerm) {
  std::mt19937 random(15);
  for (int n = 0; n < 30; ++n) {
    Case c = random_case(random, 0.02, 0.1);
    const double offsets = c.states.port_offset_rad + c.states.tag_offset_rad +
                           c.geometry.frequency_term_rad_m * c.states.electrical_length_m;
    const double once = phase_of(c) - offsets;
    c.geometry.wavenumber_rad_m *= 2.0;
    EXPECT_NEAR(phase_of(c) - offsets, 2.0 * once, 1e-11);
  }
}

TEST(PhaseModel, CountsTheWayThereAndBackInWavelengths) {
  // No motion, no lever arm: 1.5 wavelengths away is three turns of phase.
  ReadGeometry geometry;
  geometry.wavenumber_rad_m = joint_scene::wavenumber_rad_m(920e6);
  ReadStates states;
  states.p_W_X = {0.0, 1.5 * joint_scene::kLight_m_s / 920e6, 0.0};
  EXPECT_NEAR(predict_phase(geometry, states).phase_rad, 6.0 * joint_scene::kPi, 1e-12);
}

TEST(PhaseModel, AntennaStandsWhereScaleOffsetsAndLeverArmPutIt) {
  ReadGeometry geometry;
  geometry.n_W = {1.0, 0.0, 0.0};
  geometry.velocity_W = {0.0, 10.0, 0.0};
  geometry.angular_velocity_C = {0.0, 0.0, joint_scene::kPi};
  ReadStates states;
  states.log_scale = std::log(3.0);
  states.time_offset_s = 0.5;  // a quarter turn about z
  states.lever_arm_C = {0.2, 0.0, 0.0};
  states.path_correction_W = {0.0, 0.0, 0.7};
  EXPECT_NEAR((antenna_position(geometry, states) - Eigen::Vector3d(3.0, 15.2, 0.7)).norm(), 0.0, 1e-12);
}

TEST(PhaseModel, StaysFiniteInThePhaseCentre) {
  const PredictedPhase p = predict_phase({}, {});
  EXPECT_TRUE(std::isfinite(p.phase_rad));
  EXPECT_TRUE(p.jacobian.tag_position.allFinite());
}

}  // namespace
}  // namespace rfmvo
