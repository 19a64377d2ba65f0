// rfmvo diff: results that differ by what was put into them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "edges/journal.hpp"
#include "host/host_command.hpp"
#include "inspect/result_diff.hpp"
#include "support/evaluate_world.hpp"

namespace rfmvo {
namespace {

using testing::expect_one_line;
using ::testing::HasSubstr;
using testing::in_quotes;
using testing::TemporaryFolder;
using Json = nlohmann::json;

constexpr int kTheyDiffer = 3;

class Diff : public ::testing::Test {
 protected:
  void SetUp() override { write("a", original_); }
  void write(const std::string& name, const std::vector<Estimate>& result) {
    auto writer = LogWriter::create(folder_ / name, LcmConfig{}.prefix);
    ASSERT_TRUE(writer.ok()) << writer.error().text();
    for (const Estimate& estimate : result) ASSERT_TRUE(writer.value()->publish(estimate).ok());
    ASSERT_TRUE(writer.value()->close().ok());
  }
  testing::CommandResult diff(const std::string& a, const std::string& b, const std::string& more = "") {
    return testing::rfmvo("diff " + in_quotes(folder_ / a) + " " + in_quotes(folder_ / b) + " " + more);
  }
  // The original with one tag elsewhere.
  [[nodiscard]] std::vector<Estimate> with_moved_tag(const Epc& epc, const Eigen::Vector3d& by) const {
    auto result = original_;
    for (Estimate& estimate : result)
      if (auto* tag = std::get_if<TagEstimate>(&estimate); tag != nullptr && tag->epc == epc) tag->p_W_X_m += by;
    return result;
  }
  TemporaryFolder folder_;
  simulate::Truth truth_ = testing::winding_truth(100, 5);
  std::vector<Estimate> original_ = testing::perfect_result(truth_);
};

TEST_F(Diff, AResultIsTheSameAsItself) {
  const auto same = diff("a", "a");
  EXPECT_EQ(same.exit_code, 0);
  EXPECT_THAT(same.out, HasSubstr("byte for byte"));
}

TEST_F(Diff, AMovedTagIsNamedWithItsDistanceAndOnlyThat) {
  write("b", with_moved_tag(testing::epc_of(3), {0.03, 0.0, -0.04}));
  const auto result = diff("a", "b");
  EXPECT_EQ(result.exit_code, kTheyDiffer);
  EXPECT_THAT(result.out, HasSubstr("tag 30140003: "));
  EXPECT_THAT(result.out, HasSubstr("5.00 cm apart"));
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("30140002")));
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("path of")));
}

TEST_F(Diff, ToleranceDecidesFromTheDistanceOn) {
  write("b", with_moved_tag(testing::epc_of(3), {0.03, 0.0, -0.04}));
  EXPECT_EQ(diff("a", "b", "--tolerance-m 0.049").exit_code, kTheyDiffer);
  EXPECT_EQ(diff("a", "b", "--tolerance-m 0.051").exit_code, 0);
}

TEST_F(Diff, IsSymmetric) {
  write("b", with_moved_tag(testing::epc_of(1), {0.1, 0.2, 0.0}));
  const auto ab = Json::parse(diff("a", "b", "--json").out), ba = Json::parse(diff("b", "a", "--json").out);
  ASSERT_EQ(ab.at("tags").size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(ab.at("tags")[i].at("a"), ba.at("tags")[i].at("b"));
    EXPECT_EQ(ab.at("tags")[i].at("distance_m"), ba.at("tags")[i].at("distance_m"));
  }
}

TEST_F(Diff, AMissingTagDiffersWhateverTheTolerance) {
  auto result = original_;
  std::erase_if(result, [](const Estimate& e) {
    const auto* tag = std::get_if<TagEstimate>(&e);
    return tag != nullptr && tag->epc == testing::epc_of(2);
  });
  write("b", result);
  const auto differs = diff("a", "b", "--tolerance-m 1000");
  EXPECT_EQ(differs.exit_code, kTheyDiffer);
  EXPECT_THAT(differs.out, HasSubstr("| absent"));
}

TEST_F(Diff, AnotherStatusDiffersWhateverTheTolerance) {
  auto result = original_;
  std::get<TagEstimate>(result.back()).status = TagStatus::kMirror;
  write("b", result);
  EXPECT_EQ(diff("a", "b", "--tolerance-m 1000").exit_code, kTheyDiffer);
}

TEST_F(Diff, PathAndScaleAreThoseOfALongerWorld) {
  testing::Perfect longer;
  longer.metric_error = 1.02;
  write("b", testing::perfect_result(truth_, longer));
  const Json json = Json::parse(diff("a", "b", "--json").out);
  EXPECT_NEAR(json.at("scales")[0].at("relative").get<double>(), 0.02, 1e-12);
  double farthest = 0.0;
  for (const auto& pose : truth_.trajectory) farthest = std::max(farthest, 0.02 * pose.T_W_C.t.norm());
  EXPECT_NEAR(json.at("paths")[0].at("max_m").get<double>(), farthest, 1e-9);
  EXPECT_EQ(json.at("paths")[0].at("compared"), 100);
}

TEST_F(Diff, BadInputIsOneLine) {
  expect_one_line(diff("a", "nothing"), "nothing: no such file");
  expect_one_line(diff("a", ""), "", 1);
  expect_one_line(testing::rfmvo("diff " + in_quotes(folder_ / "a")), "b is required", 2);
  expect_one_line(diff("a", "a", "--tolerance-m -1"), "--tolerance-m", 2);
}

}  // namespace
}  // namespace rfmvo
