#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "montecarlo/recording.hpp"
#include "report/gnuplot.hpp"
#include "reproduce/conditions.hpp"
#include "reproduce/curves.hpp"
#include "reproduce/figures.hpp"
#include "reproduce/json.hpp"
#include "reproduce/page.hpp"
#include "reproduce/paper_run.hpp"
#include "reproduce/reasons.hpp"
#include "reproduce/scale_windows.hpp"
#include "reproduce/summary.hpp"
#include "reproduce/sweeps.hpp"

namespace rfmvo::reproduce {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// One run past two tags, few antenna arrays, no sweep.
const Options kQuick{
    .runs = 1, .jobs = 1, .first_seed = 3, .sweep_runs = 0, .tags = 2, .array_stride = 40, .images_dir = ""};

Results quick_results() {
  auto made = reproduce(kQuick, [](std::size_t, std::size_t) {});
  EXPECT_TRUE(made.ok()) << made.error().text();
  return std::move(made).value();
}

ArrayResult made_up_array(std::size_t tag, double t_s) {
  ArrayResult array;
  array.tag = tag;
  array.middle_s = t_s;
  array.span_s = 8.0;
  array.travel_m = 2.5;
  array.distance_m = 1.5 + 0.1 * t_s;
  array.hdop = 0.5 + 0.1 * t_s;
  array.true_gamma = 1.3;
  array.holds_truth = array.converged = true;
  array.search_error_m = 0.3 + 0.01 * t_s;
  array.error_m = 0.1 + 0.01 * t_s;
  array.search_scale_error = ScaleError{0.1, 0.08};
  array.scale_error = ScaleError{0.05, 0.04};
  return array;
}

PaperRun made_up_paper_run() {
  PaperRun run;
  for (int i = 0; i < 10; ++i) run.arrays.push_back(made_up_array(static_cast<std::size_t>(i % 2), i));
  run.search_error_m = {0.3, 0.4};
  run.error_m = {0.1, std::nullopt};
  run.search_scale = {{0.1, 0.08}};
  run.scale = {{0.05, 0.04}};
  run.tags = run.tags_with_enough_reads = 2;
  run.arrays_due = 12;
  run.arrays_without_range = 2;
  for (int i = 0; i < 5; ++i) run.path_m.emplace_back(0.3 * i, 0.1 * i, 0.0);
  run.search_path_m = run.path_m;
  return run;
}

// What page and numbers are tested on: nothing of it is measured.
Results made_up_results() {
  Results results;
  results.wall.scene = "wall";
  for (const std::uint64_t seed : {1U, 2U}) {
    Run run;
    run.seed = seed;
    run.span_s = 15.0;
    run.reads = 1000;
    run.paper = run.repaired = made_up_paper_run();
    run.joint_error_m = {0.04, 0.05};
    run.joint_scale = {{0.01, 0.008}, {0.02, 0.016}};
    run.joint_path_m = run.true_path_m = run.paper.path_m;
    run.joint_cpu_s = run.tagoram_cpu_s = run.mobitagbot_cpu_s = 1.0;
    run.tagoram = {BaselineTag{0.07, false}, BaselineTag{0.09, true}};
    run.mobitagbot = {BaselineTag{0.06, false}, std::nullopt};
    results.wall.runs.push_back(std::move(run));
  }
  results.sweeps = empty_sweeps();
  for (Sweep& sweep : results.sweeps)
    for (SweepPoint& point : sweep.repaired)
      point.optimized.tag_error_median_m = point.optimized.scale_relative_median = 0.2;
  results.sweep_runs = 1;
  results.conditions = empty_conditions();
  results.run_times = {{"one thing", "16 ms", 1e-3}};
  results.real_frames = results.wall;
  return results;
}

simulate::Options two_tags() {
  simulate::Options options;
  options.scene = "wall";
  options.tags = 2;
  options.seed = 3;
  return options;
}

TEST(Reproduce, MeasuresEveryMethodOnEveryTag) {
  const Results results = quick_results();
  const Study& wall = results.wall;
  ASSERT_EQ(wall.runs.size(), 1U);
  EXPECT_EQ(all_tags(wall), 2U);
  EXPECT_FALSE(results.run_times.empty());
  for (const Method method : kAllMethods) EXPECT_EQ(tag_errors_m(wall.runs[0], method).size(), 2U) << key_of(method);
  for (const Method method : {Method::kJoint, Method::kTagoram, Method::kMobiTagbot})
    EXPECT_EQ(all_tag_errors_m(wall, method).size(), 2U) << key_of(method);
  // Half the diagonal of 60 x 60 x 25 cm: no cell is farther from the tag.
  for (const Method method : {Method::kTagoram, Method::kMobiTagbot})
    for (const double error_m : all_tag_errors_m(wall, method)) EXPECT_LT(error_m, 0.45);
  for (const auto variant : {&Run::paper, &Run::repaired}) {
    const Fate fate = fate_of(wall, variant);  // each array is counted once
    EXPECT_EQ(fate.due, fate.without_range + fate.truth_excluded + fate.not_converged + fate.wrong + fate.good);
  }
}

TEST(Reproduce, JsonHasEveryColumnAndBothUnitsOfTheScale) {
  const auto json = nlohmann::json::parse(to_json(kQuick, made_up_results()));
  std::map<std::string, nlohmann::json> rows;
  for (const auto& row : json.at("summary")) {
    rows[row.at("id")] = row;
    for (const char* column : {"published", "paper", "repaired", "joint", "tagoram", "mobitagbot"})
      EXPECT_TRUE(row.contains(column)) << column;
  }
  EXPECT_DOUBLE_EQ(rows.at("tag_error_mean").at("joint"), 4.5);
  EXPECT_DOUBLE_EQ(rows.at("tag_error_mean").at("tagoram"), 8.0);
  EXPECT_DOUBLE_EQ(rows.at("tag_error_search_mean").at("paper"), 35.0);
  EXPECT_DOUBLE_EQ(rows.at("located").at("paper"), 50.0);
  EXPECT_DOUBLE_EQ(rows.at("at_edge").at("tagoram"), 50.0);
  EXPECT_DOUBLE_EQ(rows.at("scale_absolute").at("joint"), 0.015);
  EXPECT_DOUBLE_EQ(rows.at("scale_relative").at("joint"), 1.2);
  ASSERT_EQ(json.at("tags").size(), 4U);
  for (const Method method : kAllMethods) EXPECT_TRUE(json.at("tags")[0].at("error_m").contains(key_of(method)));
  EXPECT_TRUE(json.at("tags")[1].at("error_m").at("mobitagbot").is_null());
  EXPECT_EQ(json.at("sweeps").size(), 3U);
  EXPECT_FALSE(json.at("real_frames").is_null());
}

TEST(Reproduce, PageIsSelfContainedAndHasAllFigures) {
  const auto nothing = report::draw({.name = "probe", .title = "", .script = "plot 1", .legend = {}});
  if (!nothing) GTEST_SKIP() << "gnuplot is not installed";
  const auto page = make_page(made_up_results());
  ASSERT_TRUE(page.ok()) << page.error().text();
  for (const char* figure : {"Fig. 7 (a, b)", "Fig. 7 (c)", "Fig. 8 (a, b)", "Fig. 8 (c)", "Fig. 9", "Fig. 10",
                             "Fig. 11", "Fig. 12", "Fig. 13", "Run times", "why", "made easier", "Real frames"})
    EXPECT_THAT(page.value(), HasSubstr(figure));
  std::size_t plots = 0;
  for (std::size_t at = 0; (at = page.value().find("<svg", at)) != std::string::npos; ++at) ++plots;
  EXPECT_EQ(plots, 7U + 6U + 2U);  // Fig. 7 to 10; two for each of Fig. 11 to 13; the real frames
  // Namespaces of SVG are names, not addresses that are opened.
  const std::string html = std::regex_replace(page.value(), std::regex("xmlns(:xlink)?=\"[^\"]*\""), "");
  for (const char* foreign : {"http://", "https://", "src=", "<script", "<link", "@import"})
    EXPECT_THAT(html, Not(HasSubstr(foreign)));
}

TEST(Reproduce, PageSaysSoWhereNothingWasFound) {
  const auto nothing = report::draw({.name = "probe", .title = "", .script = "plot 1", .legend = {}});
  if (!nothing) GTEST_SKIP() << "gnuplot is not installed";
  Results results;
  results.sweeps = empty_sweeps();
  const auto page = make_page(results);
  ASSERT_TRUE(page.ok()) << page.error().text();
  EXPECT_THAT(page.value(), HasSubstr("No antenna array has an answer."));
}

TEST(Reproduce, FindsThePositionsThatTheEstimatorPublishes) {
  const auto recording = montecarlo::record(two_tags(), nullptr);
  ASSERT_TRUE(recording.ok());
  montecarlo::Options options;
  options.estimator = "paper";
  options.config_toml =
      "[paper]\nfix_rotation = true\nfix_cycles = true\nfix_sphere_average = true\nfix_scale_range = "
      "true\narray_stride = 40\n";
  const auto config = montecarlo::config_for(std::get<Start>(recording.value().events.front()).config, options);
  ASSERT_TRUE(config.ok()) << config.error().text();
  montecarlo::Timing timing;
  const auto published = montecarlo::estimate(recording.value(), config.value(), timing);
  const PaperRun run = run_paper(recording.value(), config.value());
  const auto evaluation = evaluate::evaluate(published, recording.value().truth);
  ASSERT_TRUE(evaluation.ok());
  ASSERT_GT(evaluation.value().tags.located, 0);
  for (std::size_t n = 0; n < run.error_m.size(); ++n) {
    const auto& tag = evaluation.value().tags.tags[n];
    ASSERT_EQ(tag.located, run.error_m[n].has_value()) << n;
    if (!tag.located) continue;
    double least = std::numeric_limits<double>::infinity();
    for (const ArrayResult& array : run.arrays)
      if (array.tag == n && array.error_m) least = std::min(least, array.hdop);
    EXPECT_EQ(tag.estimate->hdop, least) << n;
  }
}

TEST(Sweep, EachPointIsFilledOnceToTheLetterAndRepaired) {
  const auto recording = montecarlo::record(two_tags(), nullptr);
  ASSERT_TRUE(recording.ok());
  std::vector<Sweep> sweeps = empty_sweeps();
  ASSERT_EQ(sweep_points(sweeps), 2U * (7 + 4 + 3));
  Config config = std::get<Start>(recording.value().events.front()).config;
  config.paper.array_stride = 40;
  for (const std::size_t n : {0U, 1U}) fill_sweep_point(sweeps, n, {recording.value()}, config);
  EXPECT_GT(sweeps[0].paper[0].arrays_due, 0U);
  EXPECT_GT(sweeps[0].repaired[0].arrays_due, 0U);
  EXPECT_EQ(sweeps[0].paper[1].arrays_due, 0U);
  EXPECT_GT(sweeps[0].repaired[0].search.arrays, 0U);
}

// Ten seconds at 0.5 m/s along x; V is in units of 0.4 m, the recovered path is 10 % too long.
TEST(ScaleWindows, TellTheErrorInBothUnits) {
  std::vector<CameraPose> odometry;
  std::vector<MetricPose> path;
  std::vector<simulate::TruePose> truth;
  for (int i = 0; i <= 300; ++i) {
    const DeviceTime t{static_cast<std::int64_t>(i) * 33'333'333};
    const Eigen::Vector3d p(0.5 * t.ns * 1e-9, 0.0, 0.0);
    CameraPose pose;
    pose.time = t;
    pose.status = VoStatus::kTracking;
    pose.T_V_C.p_V_C = p / 0.4;
    odometry.push_back(pose);
    MetricPose metric;
    metric.time = t;
    metric.T_W_C.t = 1.1 * p;
    path.push_back(metric);
    truth.push_back({t, {Eigen::Quaterniond::Identity(), p}});
  }
  const auto errors = window_scale_errors(path, odometry, truth);
  ASSERT_EQ(errors.size(), 9U);  // 31 frames are the first that last a second
  for (const ScaleError& error : errors) {
    EXPECT_NEAR(error.relative, 0.1, 1e-9);
    EXPECT_NEAR(error.absolute, 0.04, 1e-9);
  }
  EXPECT_NEAR(true_gamma(odometry, truth, truth.front().time, truth.back().time), 0.4, 1e-12);
  EXPECT_EQ(true_gamma(odometry, truth, truth.back().time, truth.back().time), 0.0);
}

TEST(Distribution, EndsAtTheShareThatHasAnAnswer) {
  const auto points = distribution({3.0, 1.0, 2.0}, 4);
  ASSERT_EQ(points.size(), 4U);
  EXPECT_EQ(points.front(), std::pair(1.0, 0.0));
  EXPECT_EQ(points[1], std::pair(1.0, 0.25));
  EXPECT_EQ(points.back(), std::pair(3.0, 0.75));
}

TEST(InParallel, ReturnsTheFirstErrorByNumberAndCountsEveryPiece) {
  std::size_t told = 0;
  const auto all = montecarlo::in_parallel(
      20, 3, [](std::size_t) -> Status { return Done{}; },
      [&](std::size_t done, std::size_t) { told = std::max(told, done); });
  EXPECT_TRUE(all.ok());
  EXPECT_EQ(told, 20U);
  const auto failed = montecarlo::in_parallel(
      2, 2,
      [](std::size_t i) -> Status {
        return Error{ErrorCode::kOutOfRange, std::to_string(i), "piece"};
      },
      [](std::size_t, std::size_t) {});
  ASSERT_FALSE(failed.ok());
}

}  // namespace
}  // namespace rfmvo::reproduce
