// The main job on real camera frames: odometry on the kitchen sequence, simulated reads of eight tags
// along its true path, both estimators on the same events. The data is not part of the project.
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "edges/lcm_codec.hpp"
#include "estimator/pipeline.hpp"
#include "evaluate/evaluation.hpp"
#include "simulate/simulation.hpp"
#include "vision/visual_odometry.hpp"

namespace rfmvo {
namespace {

const std::string kKitchen = RFMVO_TEST_DATA "/7scenes-a";

struct RecordedRun {
  std::vector<Event> events;
  simulate::Truth truth;
};

// The run of one seed. Frames are the same for every seed, so the odometry runs once and its poses stand
// in for them: what `replay --from frames` computes, without computing it ten times.
RecordedRun kitchen(std::uint64_t seed, std::vector<CameraPose>& odometry) {
  simulate::Options options;
  options.images_dir = kKitchen;
  options.seed = seed;
  RecordedRun run;
  std::optional<VisualOdometry> vo;
  const bool known = !odometry.empty();
  std::size_t frame = 0;
  const auto sink = [&](const Event& event) -> Status {
    if (const auto* start = std::get_if<Start>(&event)) {
      Start from_poses = *start;
      from_poses.config.estimator.pose_source = "poses";
      vo.emplace(start->config.vision, start->calibration.camera);
      run.events.emplace_back(from_poses);
    } else if (const auto* picture = std::get_if<Frame>(&event)) {
      if (!known) {
        Frame decoded = *picture;
        if (const Status status = decode_image(decoded); !status) return status.error();
        odometry.push_back(vo->on(decoded));
      }
      run.events.emplace_back(odometry.at(frame++));
    } else if (!std::holds_alternative<CameraPose>(event)) {
      run.events.push_back(event);
    }
    return Done{};
  };
  auto truth = simulate::simulate(options, sink);
  EXPECT_TRUE(truth.ok());
  if (truth.ok()) run.truth = std::move(truth).value();
  return run;
}

evaluate::Evaluation estimate(const RecordedRun& run, const std::string& kind) {
  Pipeline pipeline;
  std::vector<Estimate> estimates;
  const auto keep = [&](std::span<const Estimate> some) { estimates.insert(estimates.end(), some.begin(), some.end()); };
  for (Event event : run.events) {
    if (auto* start = std::get_if<Start>(&event)) start->config.estimator.kind = kind;
    keep(pipeline.on(event));
  }
  keep(pipeline.finish());
  auto evaluation = evaluate::evaluate(estimates, run.truth);
  EXPECT_TRUE(evaluation.ok());
  return evaluation.ok() ? std::move(evaluation).value() : evaluate::Evaluation{};
}

TEST(RealFrames, TagsAndScaleInTheKitchenOverTenSeeds) {
  if (!std::filesystem::exists(kKitchen)) GTEST_SKIP() << "no real frames at " << kKitchen;
  constexpr int kSeeds = 10;
  std::vector<CameraPose> odometry;
  double joint_error_m = 0.0, scale_error = 0.0, paper_error_m = 0.0;
  int joint_located = 0, paper_located = 0, total = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const RecordedRun run = kitchen(static_cast<std::uint64_t>(seed), odometry);
    const evaluate::Evaluation joint = estimate(run, "joint");
    const evaluate::Evaluation paper = estimate(run, "paper");
    total += joint.tags.total;
    joint_located += joint.tags.located;
    paper_located += paper.tags.located;
    if (joint.tags.camera_relative_m) joint_error_m += joint.tags.camera_relative_m->mean * joint.tags.located;
    if (paper.tags.camera_relative_m) paper_error_m += paper.tags.camera_relative_m->mean * paper.tags.located;
    ASSERT_TRUE(joint.scale.relative_error.has_value()) << "seed " << seed;
    scale_error += *joint.scale.relative_error / kSeeds;
  }
  joint_error_m /= std::max(joint_located, 1);
  paper_error_m /= std::max(paper_located, 1);
  std::printf("joint: %d of %d located, camera-relative mean %.1f cm, scale error mean %.2f %%\n", joint_located, total,
              100.0 * joint_error_m, 100.0 * scale_error);
  std::printf("paper: %d of %d located, camera-relative mean %.1f cm\n", paper_located, total, 100.0 * paper_error_m);

  EXPECT_EQ(joint_located, total);
  EXPECT_LE(scale_error, 0.05);
  EXPECT_LE(joint_error_m, 0.15);
  EXPECT_TRUE(paper_located < joint_located || paper_error_m > joint_error_m);
}

}  // namespace
}  // namespace rfmvo
