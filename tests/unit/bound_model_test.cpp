// Derivatives of the bound's forward model, against finite changes of a model written down separately.
#include <gtest/gtest.h>

#include <cmath>

#include "base/units.hpp"
#include "bound/columns.hpp"
#include "simulate/radio_run.hpp"
#include "unit/bound_world.hpp"

namespace rfmvo::bound {
namespace {

// Everything unknown, as finite changes, without linearisation.
struct Changes {
  Eigen::Vector3d tag_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d lever_arm_m = Eigen::Vector3d::Zero();
  double log_scale = 0.0, time_s = 0.0, length_m = 0.0;
  int knot = -1;  // a step of scale and heading in the middle of this interval
  double scale_step = 0.0, bias_rad_m = 0.0;
  Eigen::Vector3d turn_step = Eigen::Vector3d::Zero();
};

// X = gamma * integral of (1 + e) exp(theta) dX, in steps of 1 mm.
double phase_of(const World& world, const Read& read, const Changes& change, int knots) {
  const double end_s = read.t_s - change.time_s;
  Rigid3 last = world.T_S_C(0.0);
  Eigen::Vector3d p = last.t;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  double scale = 1.0, length_m = 0.0, arc_m = 0.0;
  for (std::size_t k = 1; k < world.frame_times_s.size(); ++k)
    length_m += (world.T_S_C(world.frame_times_s[k]).t - world.T_S_C(world.frame_times_s[k - 1]).t).norm();
  const double knot_m = (change.knot + 0.5) * length_m / knots;
  const int steps = 4000;
  for (int i = 1; i <= steps; ++i) {
    const Rigid3 next = world.T_S_C(end_s * i / steps);
    const Eigen::Vector3d step_m = next.t - last.t;
    if (change.knot >= 0 && arc_m <= knot_m && arc_m + step_m.norm() > knot_m) {
      scale += change.scale_step;
      turn = so3_exp(change.turn_step) * turn;
    }
    p += scale * (turn * step_m);
    const Eigen::Vector3d down = last.R * Eigen::Vector3d::UnitY();
    turn = so3_exp(change.bias_rad_m * step_m.norm() * down) * turn;
    arc_m += step_m.norm();
    last = next;
  }
  const Eigen::Vector3d origin = world.T_S_C(0.0).t;
  const Eigen::Vector3d camera = origin + std::exp(change.log_scale) * (p - origin);
  const Eigen::Vector3d antenna = camera + turn * (last.R * (world.lever_arms_C_m[read.port] + change.lever_arm_m));
  const double k_rad_m = 4.0 * kPi * read.frequency_hz / kSpeedOfLight_m_s;
  const double k0_rad_m = 4.0 * kPi * world.reads.front().frequency_hz / kSpeedOfLight_m_s;
  return k_rad_m * (antenna - world.tags[read.tag].p_S_X_m - change.tag_m).norm() +
         (k_rad_m - k0_rad_m) * change.length_m;
}

class BoundModel : public testing::Test {
 protected:
  BoundModel() {
    settings.time_offset_sigma_s = 0.01;
    world.drift = *simulate::find_drift_class("BAD");
    world.reads[37].frequency_hz = 924e6;
  }

  // Column of the only entry of this kind: the layout of columns.hpp.
  [[nodiscard]] double column(const SparseRow& row, int index) const {
    double value = 0.0;
    for (const auto& [at, derivative] : row) {
      if (at == index) value += derivative;
    }
    return value;
  }

  World world = stacked_world(2);
  Settings settings;
};

TEST_F(BoundModel, DerivativesAreThoseOfFiniteChanges) {
  const Read at = world.reads[37];
  ASSERT_EQ(at.tag, 0U);
  ASSERT_EQ(at.port, 1U);
  const Columns columns(world, settings);
  const SparseRow row = columns.of_read(at);
  const int knots = static_cast<int>((PathDrift(world, settings.knot_spacing_m).sigmas().size() - 1) / 4);
  const auto difference = [&](const auto& set) {
    constexpr double kStep = 1e-5;
    Changes plus, minus;
    set(plus, kStep);
    set(minus, -kStep);
    return (phase_of(world, at, plus, knots) - phase_of(world, at, minus, knots)) / (2.0 * kStep);
  };
  // Tags 6, offsets 2 + 1, port 0: 9..12, port 1: 13..16, scale 17, time 18, walks from 19.
  // The path is steps of 1 mm here and of a frame there: up to a per cent of what adds up along it.
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(column(row, i), difference([i](Changes& c, double h) { c.tag_m[i] = h; }), 1e-4);
    EXPECT_NEAR(column(row, 14 + i), difference([i](Changes& c, double h) { c.lever_arm_m[i] = h; }), 1e-4);
  }
  EXPECT_NEAR(column(row, 13), difference([](Changes& c, double h) { c.length_m = h; }), 1e-6);
  EXPECT_NEAR(column(row, 17), difference([](Changes& c, double h) { c.log_scale = h; }), 1e-3);
  EXPECT_NEAR(column(row, 18), difference([](Changes& c, double h) { c.time_s = h; }), 1e-3);
  for (const int knot : {0, 5, 12}) {
    const int first = 19 + 4 * knot;
    const auto stepped = [knot](Changes& c) { c.knot = knot; };
    EXPECT_NEAR(column(row, first), difference([&](Changes& c, double h) { stepped(c), c.scale_step = h; }), 0.1);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(column(row, first + 1 + i), difference([&](Changes& c, double h) { stepped(c), c.turn_step[i] = h; }),
                  0.1)
          << knot << " " << i;
    }
  }
  const double bias = column(row, 19 + 4 * knots);
  EXPECT_NEAR(bias, difference([](Changes& c, double h) { c.bias_rad_m = h; }), 0.01 * std::abs(bias));
}

// The simulator's own phase, without its errors: another forward model again.
TEST_F(BoundModel, TagDerivativesAreThoseOfTheSimulatorsPhase) {
  simulate::Options options;
  options.scene = "S3";
  options.structured_rad = 0.0;
  const World run = world_of(options).value();
  simulate::Scene scene = simulate::make_scene(options).value();
  const Columns columns(run, settings);
  constexpr double kStep_m = 1e-6;
  for (const std::size_t k : {3U, 100U, 500U}) {
    const Read& at = run.reads[k];
    const SparseRow row = columns.of_read(at);
    for (int i = 0; i < 3; ++i) {
      double phase[2];
      for (const int sign : {0, 1}) {
        simulate::Scene moved = scene;
        moved.tags[at.tag].p_S_X_m[i] += sign == 1 ? kStep_m : -kStep_m;
        phase[sign] = simulate::make_statistical_link(moved, 1)(at.t_s, at.port, at.tag, at.frequency_hz).phase_rad;
      }
      EXPECT_NEAR(column(row, 3 * static_cast<int>(at.tag) + i), (phase[1] - phase[0]) / (2.0 * kStep_m), 1e-5);
    }
  }
}

TEST_F(BoundModel, WhitePoseNoiseActsThroughTheTwoPosesAroundTheRead) {
  const Columns columns(world, settings);
  const SparseRow row = columns.of_read(world.reads[37]);
  const int knots = static_cast<int>((PathDrift(world, settings.knot_spacing_m).sigmas().size() - 1) / 4);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [at, derivative] : row) {
    if (at >= 20 + 4 * knots) sum[(at - 20 - 4 * knots) % 3] += derivative;
  }
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(sum[i], -column(row, i), 1e-9);  // shares add to one; a tag moves the other way
}

TEST_F(BoundModel, TagInTheCameraMovesAgainstTheCamera) {
  const Columns columns(world, settings);
  const std::size_t frame = columns.closest_frame(1);
  const Eigen::MatrixXd rows = columns.of_tag_in_camera(1, frame);
  const Rigid3 T = world.T_S_C(world.frame_times_s[frame]);
  EXPECT_LT((rows.middleCols<3>(3) - T.R.toRotationMatrix().transpose()).norm(), 1e-12);
  // A scale stretches the way, not the tag: it comes nearer by as much as the camera went on.
  EXPECT_LT((rows.col(17) + T.R.conjugate() * (T.t - world.T_S_C(0.0).t)).norm(), 1e-12);
}

}  // namespace
}  // namespace rfmvo::bound
