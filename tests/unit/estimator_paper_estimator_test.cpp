#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "estimator/paper_estimator.hpp"
#include "estimator/phase_calibration.hpp"
#include "estimator/trajectory_recovery.hpp"
#include "unit/estimator_paper_scene.hpp"

namespace rfmvo {
namespace {

using paper_scene::kPi;

constexpr double kLightSpeed = 299'792'458.0;
constexpr double kSpeed_m_s = 0.3;
constexpr double kDuration_s = 13.0;

Calibration two_antennas() {
  Calibration k;  // camera forward, antennas to the left of the cart, 1 m above each other
  for (int a = 0; a < 2; ++a) {
    AntennaCalibration antenna;
    antenna.port = static_cast<std::uint8_t>(a + 1);
    antenna.p_C_A_m = {-0.1, a == 0 ? 0.5 : -0.5, -0.1};
    antenna.boresight_C = {-1, 0, 0};
    k.antennas.push_back(antenna);
  }
  k.T_B_C.t = {0.3, 0.0, 1.0};
  return k;
}

struct Stream {
  double gamma = 1.7;
  double noise_rad = 0.05;
  double hop_period_s = 0.0;  // 0: one channel
  double duration_s = kDuration_s;
  std::vector<Eigen::Vector3d> tags{{1.2, 1.6, 0.9}, {2.4, 1.5, 1.3}};
};

Eigen::Vector3d camera_W(double t) {
  const double s = kSpeed_m_s * t;
  return Eigen::Vector3d(0.3 + s, 0.15 * std::sin(1.9 * s), 1.0 + 0.15 * std::sin(2.7 * s));
}

// Cart axes to camera axes (x right = -y, y down = -z, z forward = x), without a turn of the cart.
Eigen::Vector3d W_to_V(const Eigen::Vector3d& v) { return {-v.y(), -v.z(), v.x()}; }
Eigen::Vector3d V_to_W(const Eigen::Vector3d& v) { return {v.z(), -v.x(), -v.y()}; }

DeviceTime at(double t) { return {static_cast<std::int64_t>(std::llround(t * 1e9))}; }

Epc epc_of(std::size_t tag) {
  const std::uint8_t bytes[2] = {7, static_cast<std::uint8_t>(tag)};
  return Epc::from_bytes(bytes).value();
}

SampledRead read_of(const Stream& stream, const Calibration& k, int n, double t) {
  const auto tag = static_cast<std::size_t>(n) % stream.tags.size();
  const auto port = static_cast<std::size_t>(n) / stream.tags.size() % 2;
  const int channel = stream.hop_period_s > 0.0 ? static_cast<int>(t / stream.hop_period_s) * 5 % 8 : 3;
  SampledRead s;
  s.read.time = at(t);
  s.read.epc = epc_of(tag);
  s.read.port = static_cast<std::uint8_t>(port + 1);
  s.read.frequency_hz = static_cast<std::uint32_t>(920'500'000 + 500'000 * channel);
  const double d = (camera_W(t) + V_to_W(k.antennas[port].p_C_A_m) - stream.tags[tag]).norm() + 9.5;
  s.read.phase = Phase::from_rad(4 * kPi * d * s.read.frequency_hz / kLightSpeed + 1.1 * static_cast<double>(tag) +
                                 stream.noise_rad * paper_scene::wobble(n));
  s.T_V_C.p_V_C = W_to_V(camera_W(t) - camera_W(0)) / stream.gamma;
  return s;
}

void feed(const Stream& stream, const Calibration& k, PaperEstimator& estimator) {
  const double read_s = 0.1 / static_cast<double>(stream.tags.size());
  int n = 0;
  for (int f = 0; f / 30.0 < stream.duration_s; ++f) {
    CameraPose pose;
    pose.time = at(f / 30.0);
    pose.status = VoStatus::kTracking;
    pose.T_V_C.p_V_C = W_to_V(camera_W(f / 30.0) - camera_W(0)) / stream.gamma;
    estimator.on(pose);
    for (; read_s * n <= f / 30.0; ++n) estimator.on(read_of(stream, k, n, read_s * n));
  }
}

std::vector<Estimate> run(const Stream& stream, const Config& config = {}) {
  const Calibration k = two_antennas();
  PaperEstimator estimator(config, k);
  feed(stream, k, estimator);
  std::vector<Estimate> out;
  estimator.publish(at(stream.duration_s), true, out);
  return out;
}

template <class T>
std::vector<T> all(const std::vector<Estimate>& estimates) {
  std::vector<T> found;
  for (const Estimate& e : estimates)
    if (const T* x = std::get_if<T>(&e)) found.push_back(*x);
  return found;
}

Config fixed() {
  Config c;
  c.paper.fix_rotation = c.paper.fix_sphere_average = c.paper.fix_cycles = c.paper.fix_scale_range = true;
  return c;
}

void expect_located(const std::vector<Estimate>& out, const Stream& stream, double limit_m) {
  const auto tags = all<TagEstimate>(out);
  ASSERT_EQ(tags.size(), stream.tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    EXPECT_EQ(tags[i].epc, epc_of(i));
    EXPECT_EQ(tags[i].status, TagStatus::kConverged);
    EXPECT_LT((tags[i].p_W_X_m - stream.tags[i]).norm(), limit_m) << "tag " << i;
    EXPECT_GT(tags[i].hdop, 0.0);
    EXPECT_TRUE(tags[i].covariance_m2.allFinite());
    EXPECT_GT(tags[i].covariance_m2.diagonal().minCoeff(), 0.0);
    const double closest = (stream.tags[i] - camera_W(tags[i].closest_approach.ns * 1e-9)).norm();
    EXPECT_NEAR(tags[i].p_C_X_m.norm(), closest, limit_m);
  }
}

// 5 cm: three times the error of the four parameters that 0.05 rad of even noise gives here.
constexpr double kLimit_m = 0.05;

TEST(PaperEstimator, LocatesTagsAndRecoversTheScaleOnASlowPathInThreeDimensions) {
  const Stream stream;
  const auto out = run(stream);
  expect_located(out, stream, kLimit_m);
  const auto scale = all<ScaleEstimate>(out);
  ASSERT_EQ(scale.size(), 1u);
  EXPECT_TRUE(scale[0].observable);
  EXPECT_NEAR(scale[0].m_per_unit / stream.gamma, 1.0, 0.02);
  const auto path = all<Trajectory>(out);
  ASSERT_EQ(path.size(), 1u);
  ASSERT_FALSE(path[0].poses.empty());
  for (const MetricPose& pose : path[0].poses)
    EXPECT_LT((pose.T_W_C.t - camera_W(pose.time.ns * 1e-9)).norm(), kLimit_m);
}

TEST(PaperEstimator, DoesSoWithItsRepairsInAnyUnitOfVisualOdometry) {
  for (const double gamma : {0.5, 1.7, 3.0}) {
    Stream stream;
    stream.gamma = gamma;
    expect_located(run(stream, fixed()), stream, kLimit_m);
  }
}

TEST(PaperEstimator, LearnsTheOffsetsOfAHoppingReader) {
  Stream stream;
  stream.hop_period_s = 0.4;
  expect_located(run(stream, fixed()), stream, 4 * kLimit_m);  // the first hops are not calibrated yet
}

TEST(PaperEstimator, GivesTheSameBitsTwice) {
  const auto a = all<TagEstimate>(run({})), b = all<TagEstimate>(run({}));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(std::memcmp(a[i].p_W_X_m.data(), b[i].p_W_X_m.data(), 3 * sizeof(double)), 0);
    EXPECT_EQ(std::memcmp(a[i].covariance_m2.data(), b[i].covariance_m2.data(), 9 * sizeof(double)), 0);
  }
}

TEST(PaperEstimator, SaysTooFewReadsBeforeOneArray) {
  Stream stream;
  stream.duration_s = 11.0;  // 55 reads per antenna, L = 60
  const auto out = run(stream);
  for (const TagEstimate& tag : all<TagEstimate>(out)) EXPECT_EQ(tag.status, TagStatus::kTooFewReads);
  EXPECT_FALSE(all<ScaleEstimate>(out).at(0).observable);
  EXPECT_TRUE(all<Trajectory>(out).at(0).poses.empty());
}

TEST(PaperEstimator, IgnoresReadsWithoutPhaseOrFromUnknownPorts) {
  const Calibration k = two_antennas();
  PaperEstimator estimator({}, k);
  CameraPose pose;
  pose.status = VoStatus::kTracking;
  estimator.on(pose);
  SampledRead read = read_of({}, k, 0, 0.0);
  read.read.port = 9;
  estimator.on(read);
  read.read.port = 1;
  read.read.seen_count = 2;
  estimator.on(read);
  std::vector<Estimate> out;
  estimator.publish(at(1.0), false, out);
  EXPECT_TRUE(all<TagEstimate>(out).empty());
}

TEST(PaperEstimator, SaysNothingBeforeTheFirstPose) {
  PaperEstimator estimator({}, two_antennas());
  std::vector<Estimate> out;
  estimator.publish(at(1.0), true, out);
  EXPECT_TRUE(out.empty());
}

TEST(PhaseCalibration, FindsTheElectricalLengthOfAPort) {
  const Calibration k = two_antennas();
  Stream stream;
  stream.hop_period_s = 0.2;
  stream.tags.resize(1);
  PhaseCalibration phases;
  EXPECT_FALSE(phases.excess_length_m(1).has_value());
  for (int n = 0; n < 400; n += 2)  // even: one port
    phases.on_pair(read_of(stream, k, n, 0.05 * n).read, read_of(stream, k, n + 4, 0.05 * (n + 4)).read);
  ASSERT_TRUE(phases.excess_length_m(1).has_value());
  EXPECT_NEAR(*phases.excess_length_m(1), 9.5 + 2.5, 2.0);  // 9.5 m of cable and the mean distance to the tag
}

TEST(TrajectoryRecovery, GivesEachStepTheScaleOfLeastHdop) {
  TrajectoryRecovery recovery(Rigid3{});
  for (int i = 0; i <= 4; ++i) {
    CameraPose pose;
    pose.time = at(i);
    pose.status = VoStatus::kTracking;
    pose.T_V_C.p_V_C = {0.0, 0.0, static_cast<double>(i)};
    recovery.on(pose);
  }
  EXPECT_TRUE(recovery.path().empty());
  recovery.on(ScaleCandidate{at(1), at(3), 2.0, 0.1, 0.5});
  recovery.on(ScaleCandidate{at(3), at(4), 5.0, 0.1, 0.2});
  const auto path = recovery.path();
  ASSERT_EQ(path.size(), 5u);
  const double expected[] = {0.0, 2.0, 4.0, 9.0, 14.0};  // Eq. (29)
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(path[i].T_W_C.t.z(), expected[i], 1e-12) << i;
  EXPECT_NEAR(position_at(path, at(1.5)).z(), 3.0, 1e-12);
  EXPECT_EQ(recovery.best()->gamma, 5.0);
}

TEST(TrajectoryRecovery, GoesOnFromTheLastPoseInANewSegment) {
  TrajectoryRecovery recovery(Rigid3{});
  CameraPose pose;
  pose.status = VoStatus::kTracking;
  pose.T_V_C.p_V_C = {0, 0, 1};
  pose.time = at(1);
  recovery.on(pose);
  recovery.on(ScaleCandidate{at(0), at(1), 2.0, 0.1, 0.5});
  pose.segment = 1;
  pose.time = at(2);
  recovery.on(pose);
  EXPECT_TRUE(recovery.path().empty());
  recovery.on(ScaleCandidate{at(2), at(3), 3.0, 0.1, 0.5});
  EXPECT_NEAR(recovery.path().at(0).T_W_C.t.z(), 2.0 + 3.0, 1e-12);
}

}  // namespace
}  // namespace rfmvo
