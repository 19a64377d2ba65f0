#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "montecarlo/recording.hpp"
#include "report/gnuplot.hpp"
#include "reproduce/curves.hpp"
#include "reproduce/figures.hpp"
#include "reproduce/json.hpp"
#include "reproduce/page.hpp"
#include "reproduce/paper_run.hpp"
#include "reproduce/scale_windows.hpp"
#include "reproduce/summary.hpp"
#include "reproduce/sweeps.hpp"

namespace rfmvo::reproduce {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// One run past two tags, no sweep: what all tests of page and numbers look at.
const Options kQuick{.runs = 1, .jobs = 1, .first_seed = 3, .sweep_runs = 0, .tags = 2, .images_dir = ""};

const Results& quick_results() {
  static const Results results = [] {
    auto made = reproduce(kQuick, [](std::size_t, std::size_t) {});
    EXPECT_TRUE(made.ok()) << made.error().text();
    return std::move(made).value();
  }();
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
  const Study& wall = quick_results().wall;
  ASSERT_EQ(wall.runs.size(), 1U);
  EXPECT_EQ(all_tags(wall), 2U);
  for (const Method method : kAllMethods) EXPECT_EQ(tag_errors_m(wall.runs[0], method).size(), 2U) << key_of(method);
  for (const Method method : {Method::kJoint, Method::kTagoram, Method::kMobiTagbot})
    EXPECT_EQ(all_tag_errors_m(wall, method).size(), 2U) << key_of(method);
  // Half the diagonal of 60 x 60 x 25 cm: no cell is farther from the tag.
  for (const Method method : {Method::kTagoram, Method::kMobiTagbot})
    for (const double error_m : all_tag_errors_m(wall, method)) EXPECT_LT(error_m, 0.45);
}

TEST(Reproduce, DoesNotDependOnTheNumberOfJobs) {
  Options two = kQuick;
  two.jobs = 2;
  const auto again = reproduce(two, [](std::size_t, std::size_t) {});
  ASSERT_TRUE(again.ok());
  const Study &a = quick_results().wall, &b = again.value().wall;
  for (const Method method : kAllMethods) EXPECT_EQ(all_tag_errors_m(a, method), all_tag_errors_m(b, method));
}

TEST(Reproduce, JsonHasEveryColumnAndBothUnitsOfTheScale) {
  const auto json = nlohmann::json::parse(to_json(kQuick, quick_results()));
  std::set<std::string> ids;
  for (const auto& row : json.at("summary")) {
    ids.insert(row.at("id"));
    for (const char* column : {"published", "paper", "repaired", "joint", "tagoram", "mobitagbot"})
      EXPECT_TRUE(row.contains(column)) << column;
  }
  for (const char* id : {"located", "tag_error_search_mean", "tag_error_mean", "scale_absolute", "scale_relative"})
    EXPECT_TRUE(ids.contains(id)) << id;
  ASSERT_EQ(json.at("tags").size(), 2U);
  for (const Method method : kAllMethods) EXPECT_TRUE(json.at("tags")[0].at("error_m").contains(key_of(method)));
  EXPECT_FALSE(json.at("run_times").empty());
  EXPECT_TRUE(json.at("real_frames").is_null());
}

TEST(Reproduce, JsonCountsEachArrayOnce) {
  const auto json = nlohmann::json::parse(to_json(kQuick, quick_results()));
  for (const char* variant : {"paper", "repaired"}) {
    const auto& fate = json.at("reasons").at(variant);
    const auto of = [&](const char* key) { return fate.at(key).get<std::size_t>(); };
    EXPECT_EQ(of("arrays_due"),
              of("without_range") + of("truth_excluded") + of("not_converged") + of("wrong") + of("good"))
        << variant;
  }
}

TEST(Reproduce, PageIsSelfContainedAndHasAllFigures) {
  const auto nothing = report::draw({.name = "probe", .title = "", .script = "plot 1", .legend = {}});
  if (!nothing) GTEST_SKIP() << "gnuplot is not installed";
  const auto page = make_page(quick_results());
  ASSERT_TRUE(page.ok()) << page.error().text();
  for (const char* figure : {"Fig. 7 (a, b)", "Fig. 7 (c)", "Fig. 8 (a, b)", "Fig. 8 (c)", "Fig. 9", "Fig. 10",
                             "Fig. 11", "Fig. 12", "Fig. 13", "Run times", "why"})
    EXPECT_THAT(page.value(), HasSubstr(figure));
  // Namespaces of SVG are names, not addresses that are opened.
  const std::string html = std::regex_replace(page.value(), std::regex("xmlns(:xlink)?=\"[^\"]*\""), "");
  for (const char* foreign : {"http://", "https://", "src=", "<script", "<link", "@import"})
    EXPECT_THAT(html, Not(HasSubstr(foreign)));
}

TEST(Reproduce, FindsThePositionsThatTheEstimatorPublishes) {
  const auto recording = montecarlo::record(two_tags(), nullptr);
  ASSERT_TRUE(recording.ok());
  montecarlo::Options options;
  options.estimator = "paper";
  options.config_toml =
      "[paper]\nfix_rotation = true\nfix_cycles = true\nfix_sphere_average = true\nfix_scale_range = true\n";
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
