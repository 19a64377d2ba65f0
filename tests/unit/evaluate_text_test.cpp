#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands/export_text.hpp"
#include "commands/whole_file.hpp"
#include "evaluate/evaluation_text.hpp"
#include "support/evaluate_world.hpp"

namespace rfmvo::evaluate {
namespace {

using namespace rfmvo::testing;  // NOLINT(google-build-using-namespace)
using ::testing::HasSubstr;

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(EvaluationJson, HasTheKeysThatProgramsReadAndTheRightNumbers) {
  const auto truth = winding_truth(400, 8);
  const auto evaluation = evaluate(perfect_result(truth, {.metric_error = 1.02}), truth).value();
  const auto json = nlohmann::json::parse(to_json(evaluation, 12.5));
  EXPECT_EQ(json["tags"]["total"], 8);
  EXPECT_EQ(json["tags"]["located"], 8);
  for (const char* key : {"mean_error_m", "rmse_m", "camera_relative_mean_m", "coverage95"}) {
    EXPECT_TRUE(json["tags"][key].is_number()) << key;
  }
  EXPECT_NEAR(json["scale"]["relative_error"].get<double>(), 0.02, 0.0005);
  EXPECT_TRUE(json["scale"]["eq31"].is_number());
  EXPECT_TRUE(json["trajectory"]["ate_se3_m"].is_number());
  EXPECT_TRUE(json["trajectory"]["ate_sim3_m"].is_number());
  EXPECT_GT(json["trajectory"]["path_m"].get<double>(), 8.0);
  EXPECT_EQ(json["realtime_factor"], 12.5);
  EXPECT_EQ(json["tags"]["list"].size(), 8u);
  EXPECT_EQ(json["tags"]["list"][0]["status"], "CONVERGED");
}

TEST(EvaluationJson, SaysNullForWhatIsNotKnown) {
  const auto truth = winding_truth(400, 8);
  const auto json = nlohmann::json::parse(to_json(evaluate({}, truth).value(), std::nullopt));
  EXPECT_TRUE(json["tags"].contains("mean_error_m"));
  EXPECT_TRUE(json["tags"]["mean_error_m"].is_null());
  EXPECT_TRUE(json["tags"]["coverage95"].is_null());
  EXPECT_TRUE(json["scale"]["relative_error"].is_null());
  EXPECT_TRUE(json["trajectory"]["ate_se3_m"].is_null());
  EXPECT_TRUE(json["realtime_factor"].is_null());
  EXPECT_EQ(json["tags"]["located"], 0);
}

TEST(EvaluationTable, HasARowForEveryTrueTag) {
  const auto truth = winding_truth(400, 8);
  auto result = perfect_result(truth);
  result.pop_back();
  const std::string table = to_table(evaluate(result, truth).value());
  for (const auto& tag : truth.tags) EXPECT_THAT(table, HasSubstr(tag.epc.hex()));
  EXPECT_THAT(table, HasSubstr("NOT_SEEN"));
  EXPECT_THAT(table, HasSubstr("7 of 8 located"));
  EXPECT_THAT(table, HasSubstr("1 sigma 1.00 %"));
}

TEST(ReplayJson, GivesTheRealtimeFactorOrSaysWhatIsWrong) {
  EXPECT_EQ(realtime_factor_of(R"({"realtime_factor": 3.5})", "f").value(), 3.5);
  EXPECT_FALSE(realtime_factor_of(R"({"realtime_factor": null})", "f").value().has_value());
  EXPECT_EQ(realtime_factor_of(R"({"realtime_factor": "fast"})", "f.json").error().where, "f.json");
  EXPECT_FALSE(realtime_factor_of("{}", "f").ok());
  EXPECT_FALSE(realtime_factor_of("[1, 2", "f").ok());
}

TEST(Export, TumHasEveryPoseWithNanosecondsAndUnitQuaternions) {
  const auto truth = winding_truth(30, 0);
  auto result = perfect_result(truth);
  const auto lines = lines_of(to_tum(last_of(result)));
  ASSERT_EQ(lines.size(), 30u);
  EXPECT_EQ(lines[1].substr(0, 21), "1700000000.040000000 ");
  for (const std::string& line : lines) {
    std::istringstream stream(line);
    double t = 0, x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 0;
    ASSERT_TRUE(stream >> t >> x >> y >> z >> qx >> qy >> qz >> qw) << line;
    EXPECT_NEAR(qx * qx + qy * qy + qz * qz + qw * qw, 1.0, 1e-10);
  }
}

TEST(Export, TagsCsvHasOneRowPerTagAndNoNumbersForTagsWithoutPosition) {
  const auto truth = winding_truth(30, 3);
  auto result = perfect_result(truth);
  std::get<TagEstimate>(result.back()).status = TagStatus::kTooFewReads;
  const auto lines = lines_of(to_tags_csv(last_of(result)));
  ASSERT_EQ(lines.size(), 4u);
  const auto columns = std::count(lines[0].begin(), lines[0].end(), ',');
  for (const auto& line : lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns);
  EXPECT_EQ(lines[1].substr(0, 19), "30140000,CONVERGED,");
  EXPECT_EQ(lines[3], "30140002,TOO_FEW_READS,,,,,,,,,,,40,0,");
}

class WholeFileTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::size_t entries() const {
    const auto all = std::filesystem::directory_iterator(folder_);
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }
  const std::string name_ = ::testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) / ("whole_file_" + name_);
};

TEST_F(WholeFileTest, ReplacesTheOldContentAtOnce) {
  const std::string path = folder_ / "a";
  ASSERT_TRUE(write_whole_file(path, "old").ok());
  ASSERT_TRUE(write_whole_file(path, "new").ok());
  EXPECT_EQ(read_whole_file(path).value(), "new");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(WholeFileTest, LeavesNothingWithoutCommit) {
  {
    const auto staged = WholeFile::stage(folder_ / "a", "half");
    ASSERT_TRUE(staged.ok());
  }
  EXPECT_EQ(entries(), 0u);
}

TEST_F(WholeFileTest, UnwritablePlacesAreErrorsThatNameThem) {
  const std::string path = folder_ / "missing" / "a";
  const auto status = write_whole_file(path, "x");
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().where, path);
  EXPECT_FALSE(write_whole_file(folder_, "x").ok());
  EXPECT_FALSE(read_whole_file(path).ok());
}

}  // namespace
}  // namespace rfmvo::evaluate
