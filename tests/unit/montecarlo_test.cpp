// Many seeds at once: what is counted, and that neither threads nor order change it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "montecarlo/recording.hpp"
#include "montecarlo/statistics_text.hpp"

namespace rfmvo::montecarlo {
namespace {

const Progress kQuiet = [](std::size_t, std::size_t) {};

Options options_of(const char* scene, std::size_t seeds) {
  Options options;
  options.simulation.scene = scene;
  options.seeds = seeds;
  return options;
}

// A tag that says it is at sigma_m (each axis) of where it is believed, and is error_m from its truth.
evaluate::TagEvaluation tag_of(double error_m, double sigma_m, TagStatus status = TagStatus::kConverged) {
  evaluate::TagEvaluation tag;
  tag.estimate = TagEstimate{};
  tag.estimate->status = status;
  tag.estimate->covariance_C_m2 = sigma_m * sigma_m * Eigen::Matrix3d::Identity();
  tag.located = true;
  tag.camera_relative_error_m = error_m;
  if (sigma_m > 0.0) tag.nees_camera = error_m * error_m / (sigma_m * sigma_m);
  return tag;
}

SeedRun run_of(std::vector<evaluate::TagEvaluation> tags, double scale_error) {
  SeedRun run;
  run.evaluation.tags.tags = std::move(tags);
  run.evaluation.scale.relative_error = scale_error;
  return run;
}

TEST(MonteCarlo, UnflaggedWrongIsAConvergedTagThatIsNotWhereItSays) {
  EXPECT_FALSE(is_unflagged_wrong(tag_of(0.05, 0.01)));  // 5 sigma on one axis: 25 < 30.7
  EXPECT_TRUE(is_unflagged_wrong(tag_of(0.06, 0.01)));
  EXPECT_FALSE(is_unflagged_wrong(tag_of(0.6, 0.01, TagStatus::kMirror)));
  EXPECT_TRUE(is_unflagged_wrong(tag_of(0.01, 0.0)));  // claims certainty
  // Long in one axis and wrong in another: far beyond its sigma before the ellipsoid is left.
  evaluate::TagEvaluation tag = tag_of(0.9, 0.2);
  EXPECT_FALSE(is_unflagged_wrong(tag));  // 2.6 published sigmas (root of the trace)
  tag.camera_relative_error_m = 1.1;
  tag.nees_camera = kChi2_1em6_3dof - 0.1;
  EXPECT_TRUE(is_unflagged_wrong(tag));
}

TEST(MonteCarlo, StatisticsPoolTheTagsOfAllSeeds) {
  Options options = options_of("S3", 2);
  evaluate::TagEvaluation unseen;
  const std::vector<SeedRun> runs{run_of({tag_of(0.03, 0.02), tag_of(0.5, 0.4, TagStatus::kMirror)}, 0.03),
                                  run_of({tag_of(0.07, 0.01), unseen}, 0.04)};
  const Statistics s = statistics_of(runs, options);
  EXPECT_EQ(s.tags, 4U);
  EXPECT_EQ(s.located, 3U);
  EXPECT_NEAR(s.error_m->rmse, std::sqrt((0.03 * 0.03 + 0.5 * 0.5 + 0.07 * 0.07) / 3.0), 1e-12);
  EXPECT_DOUBLE_EQ(s.error_m->median, 0.07);
  EXPECT_NEAR(*s.coverage95, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(*s.scale_rms_relative, std::sqrt(0.5 * (0.03 * 0.03 + 0.04 * 0.04)), 1e-12);
  EXPECT_EQ(s.unflagged_wrong, 1U);
  EXPECT_EQ(s.unflagged_wrong_that_matters, 0U);
  EXPECT_EQ(s.false_alarms, 2U);
  EXPECT_EQ(s.located_sigma25, 2U);
  EXPECT_EQ(s.statuses.at("NOT_SEEN"), 1U);
  options.simulation.scene = "straight1ant";
  EXPECT_FALSE(statistics_of(runs, options).false_alarms.has_value());
}

TEST(MonteCarlo, BoundIsThatOfTheLocatedTagsThatHaveOne) {
  evaluate::TagEvaluation unseen;
  SeedRun run = run_of({tag_of(0.03, 0.02), tag_of(0.04, 0.02), tag_of(0.5, 0.4), unseen}, 0.02);
  run.bound.emplace();
  run.bound->tags.resize(4);
  run.bound->tags[0].sigma_m = 0.01;
  run.bound->tags[1].sigma_m = 0.02;  // the third has none, the fourth was not located
  run.bound->tags[3].sigma_m = 5.0;
  run.bound->unbounded = 1;
  run.bound->scale_relative = 0.01;
  const Statistics s = statistics_of({run}, options_of("S3", 1));
  EXPECT_NEAR(*s.bound_rmse_m, std::sqrt(0.5 * (0.01 * 0.01 + 0.02 * 0.02)), 1e-12);
  EXPECT_NEAR(*s.ratio, std::sqrt((0.03 * 0.03 + 0.04 * 0.04) / (0.01 * 0.01 + 0.02 * 0.02)), 1e-12);
  EXPECT_EQ(s.unbounded, 1U);
  EXPECT_NEAR(*s.scale_bound_rms_relative, 0.01, 1e-15);
}

TEST(MonteCarlo, AnyNumberOfJobsGivesTheSameResultInOrderOfTheSeeds) {
  Options options = options_of("onetag", 3);
  options.estimator = "paper";
  options.first_seed = 5;
  std::string one;
  for (const std::size_t jobs : {1U, 3U}) {
    options.jobs = jobs;
    auto result = run(options, kQuiet);
    ASSERT_TRUE(result.ok());
    std::vector<SeedRun> runs = std::move(result).value();
    for (SeedRun& seed : runs) seed.timing = {};
    const std::string json = to_json(options, runs, statistics_of(runs, options));
    if (one.empty()) one = json;
    EXPECT_EQ(json, one);
    ASSERT_EQ(runs.size(), 3U);
    EXPECT_EQ(runs[0].seed, 5U);
    EXPECT_EQ(runs[2].seed, 7U);
    EXPECT_GT(runs[0].reads, 0U);
    EXPECT_TRUE(runs[0].bound.has_value());
  }
}

TEST(MonteCarlo, JsonHoldsTheFiguresByName) {
  const Options options = options_of("S3", 1);
  const std::vector<SeedRun> runs{run_of({tag_of(0.03, 0.02)}, 0.01)};
  const auto json = nlohmann::json::parse(to_json(options, runs, statistics_of(runs, options)));
  EXPECT_DOUBLE_EQ(json.at("rmse_m"), 0.03);
  EXPECT_DOUBLE_EQ(json.at("scale_rms_relative"), 0.01);
  EXPECT_EQ(json.at("unflagged_wrong").at("count"), 0);
  EXPECT_EQ(json.at("statuses").at("CONVERGED"), 1);
  EXPECT_TRUE(json.at("known_path_rmse_m").is_null());
  EXPECT_EQ(json.at("seeds").size(), 1U);
  for (const char* key : {"ratio", "bound_rmse_m", "median_error_m", "mean_error_m", "coverage95", "nees",
                          "scale_bound_rms_relative", "false_alarms", "located_sigma25_share", "per_read_p99_ms"})
    EXPECT_TRUE(json.contains(key)) << key;
}

TEST(MonteCarlo, KnownPathIsEstimatedFromPosesWithoutDrift) {
  Options options = options_of("onetag", 1);
  options.estimator = "paper";
  options.simulation.vo_class = "BAD";
  options.known_path = true;
  const auto runs = run(options, kQuiet);
  ASSERT_TRUE(runs.ok());
  EXPECT_TRUE(runs.value()[0].known_path.has_value());
}

TEST(MonteCarlo, FramesOfASceneWithoutFramesAreAnErrorThatNamesTheSeed) {
  Options options = options_of("S3", 2);
  options.own_odometry = true;
  const auto runs = run(options, kQuiet);
  ASSERT_FALSE(runs.ok());
  EXPECT_NE(runs.error().text().find("seed 1: the scene has no frames"), std::string::npos) << runs.error().text();
}

TEST(MonteCarlo, ConfigurationOfTheUserIsLaidOverTheRuns) {
  Options options = options_of("S3", 1);
  options.config_toml = "[joint]\nknot_spacing_m = 0.5\n";
  options.config_name = "my.toml";
  const auto config = config_for(Config{}, options);
  ASSERT_TRUE(config.ok());
  EXPECT_EQ(config.value().joint.knot_spacing_m, 0.5);
  options.config_toml = "[joint]\nknot_spcing_m = 0.5\n";
  ASSERT_FALSE(config_for(Config{}, options).ok());
  EXPECT_NE(config_for(Config{}, options).error().text().find("my.toml"), std::string::npos);
}

}  // namespace
}  // namespace rfmvo::montecarlo
