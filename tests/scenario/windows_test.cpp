// A drive longer than a window, and one on which the odometry was lost: one map all the same.
#include <gtest/gtest.h>

#include "estimator/joint_estimator.hpp"
#include "estimator/sampling_synchronization.hpp"
#include "evaluate/evaluation.hpp"
#include "evaluate/last_estimates.hpp"
#include "montecarlo/recording.hpp"

namespace rfmvo {
namespace {

montecarlo::Recording aisle(double frame_gap_s) {
  montecarlo::Options options;
  options.simulation.scene = "aisle";
  options.simulation.seed = 1;
  options.simulation.frame_gap_s = frame_gap_s;
  auto recording = montecarlo::record(options.simulation, nullptr);
  EXPECT_TRUE(recording.ok());
  return std::move(recording).value();
}

std::vector<Estimate> run(const montecarlo::Recording& recording, const Window& window) {
  const auto& start = std::get<Start>(recording.events.front());
  SamplingSynchronization synchronization(start.config);
  JointEstimator estimator(start.config, start.calibration, window);
  std::vector<Estimate> out;
  DeviceTime published = start.time, now = start.time;
  const auto feed = [&](const std::vector<SampledRead>& reads) {
    for (const SampledRead& read : reads) estimator.on(read);
  };
  for (const Event& event : recording.events) {
    now = std::max(now, time_of(event));
    if (const auto* pose = std::get_if<CameraPose>(&event)) {
      out.emplace_back(*pose);
      estimator.on(*pose);
      feed(synchronization.on(*pose));
    } else if (const auto* read = std::get_if<TagRead>(&event)) {
      feed(synchronization.on(*read));
    }
    if ((now - published).seconds() < 1.0) continue;
    estimator.publish(now, false, out);
    published = now;
  }
  estimator.publish(now, true, out);
  return out;
}

TEST(Windows, LongDriveIsOneMapInSeveralWindows) {
  const montecarlo::Recording recording = aisle(0.0);
  const auto estimates = run(recording, {.length_m = 4.0});
  const evaluate::LastEstimates last = evaluate::last_of(estimates);
  // The whole path is told, though no window held it.
  ASSERT_EQ(last.trajectories.size(), 1U);
  const Trajectory& path = last.trajectories.begin()->second;
  EXPECT_LT((path.poses.front().time - last.camera_poses.front().time).seconds(), 0.1);
  EXPECT_LT((last.camera_poses.back().time - path.poses.back().time).seconds(), 0.1);
  EXPECT_GT((path.poses.back().T_W_C.t - path.poses.front().T_W_C.t).norm(), 5.5);  // 6.3 m were driven
  // No step in it where one window takes over from another.
  for (std::size_t i = 1; i < path.poses.size(); ++i)
    ASSERT_LT((path.poses[i].T_W_C.t - path.poses[i - 1].T_W_C.t).norm(), 0.06) << i;
  const auto evaluation = evaluate::evaluate(estimates, recording.truth);
  ASSERT_TRUE(evaluation.ok());
  EXPECT_EQ(evaluation.value().tags.located, evaluation.value().tags.total);
  EXPECT_LT(evaluation.value().tags.camera_relative_m->median, 0.10);
}

TEST(Windows, MapForgetsNothingAndTheNewestUncertaintyIncludesTheWayThere) {
  const montecarlo::Recording recording = aisle(0.0);
  const auto estimates = run(recording, {.length_m = 2.0});
  const evaluate::LastEstimates last = evaluate::last_of(estimates);
  EXPECT_EQ(last.tags.size(), recording.truth.tags.size());
  const std::vector<MetricPose>& poses = last.trajectories.begin()->second.poses;
  const auto variance_m2 = [](const MetricPose& pose) { return pose.covariance.diagonal().head(3).sum(); };
  EXPECT_GT(variance_m2(poses.back()), variance_m2(poses[poses.size() / 2]));
}

TEST(Windows, SegmentsAreJoinedThroughTheirTags) {
  const montecarlo::Recording recording = aisle(1.0);
  const auto estimates = run(recording, {});
  const evaluate::LastEstimates last = evaluate::last_of(estimates);
  ASSERT_EQ(last.trajectories.size(), 2U);
  const auto evaluation = evaluate::evaluate(estimates, recording.truth);
  ASSERT_TRUE(evaluation.ok());
  EXPECT_LT(evaluation.value().tags.camera_relative_m->mean, 0.08);
  // Both pieces lie in one frame: the alignment of the first one puts the second right, too.
  const auto& segments = evaluation.value().trajectory.segments;
  ASSERT_EQ(segments.size(), 2U);
  const Rigid3 difference = segments[0].T_truth_W.inverse() * segments[1].T_truth_W;
  const Eigen::Vector3d far = last.trajectories.rbegin()->second.poses.back().T_W_C.t;
  EXPECT_LT((difference * far - far).norm(), 0.15);
}

}  // namespace
}  // namespace rfmvo
