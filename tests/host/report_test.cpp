#include "report/report.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>

#include "report/gnuplot.hpp"
#include "report/html.hpp"
#include "support/evaluate_world.hpp"

namespace rfmvo::report {
namespace {

using namespace rfmvo::testing;  // NOLINT(google-build-using-namespace)
using ::testing::HasSubstr;
using ::testing::Not;

// PATH for the life of the object.
class PathWas {
 public:
  explicit PathWas(const std::string& path) : old_(std::getenv("PATH") == nullptr ? "" : std::getenv("PATH")) {
    ::setenv("PATH", path.c_str(), 1);
  }
  ~PathWas() { ::setenv("PATH", old_.c_str(), 1); }
  PathWas(const PathWas&) = delete;
  PathWas& operator=(const PathWas&) = delete;

 private:
  std::string old_;
};

bool has_gnuplot() {
  const auto nothing = draw({.name = "probe", .title = "", .script = "plot 1", .legend = {}});
  return nothing.ok();
}

std::vector<Estimate> result_with_history(const simulate::Truth& truth) {
  auto result = noisy_result(truth);
  for (Estimate& estimate : result) {
    if (auto* tag = std::get_if<TagEstimate>(&estimate)) tag->time = frame_time(200);
    if (auto* scale = std::get_if<ScaleEstimate>(&estimate)) scale->time = frame_time(200);
  }
  Health health;
  health.time = frame_time(399);
  health.faults = 1;
  health.last_fault = "<script>alert('x')</script>";
  result.emplace_back(health);
  return result;
}

TEST(Escape, MakesTextSafeForContentAndAttributes) {
  EXPECT_EQ(escape("a<b>&\"c'"), "a&lt;b&gt;&amp;&quot;c&#39;");
  EXPECT_EQ(escape("σ ä 日"), "σ ä 日");
}

TEST(Escape, ReplacesControlCharactersAndBrokenUtf8) {
  const std::string broken = "\xEF\xBF\xBD";
  EXPECT_EQ(escape(std::string("a\x01z")), "a" + broken + "z");
  EXPECT_EQ(escape(std::string("a\0z", 3)), "a" + broken + "z");
  EXPECT_EQ(escape("\xC0\xAF"), broken + broken);               // overlong "/"
  EXPECT_EQ(escape("\xE2\x82"), broken + broken);               // cut off
  EXPECT_EQ(escape("\xED\xA0\x80"), broken + broken + broken);  // a surrogate
}

TEST(Gnuplot, MissingProgramIsAnErrorThatNamesThePackage) {
  const PathWas empty("/nonexistent");
  const auto svg = draw({.name = "a", .title = "", .script = "plot 1", .legend = {}});
  ASSERT_FALSE(svg.ok());
  EXPECT_THAT(svg.error().text(), HasSubstr("gnuplot-nox"));
}

TEST(Gnuplot, ComplaintIsOneLine) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const auto svg = draw({.name = "a", .title = "", .script = "no such command", .legend = {}});
  ASSERT_FALSE(svg.ok());
  EXPECT_THAT(svg.error().text(), Not(HasSubstr("\n")));
}

TEST(Report, IsOneSelfContainedPage) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const auto truth = winding_truth(400, 12);
  const auto page = make_report(result_with_history(truth), truth, "a & <b>.lcmlog");
  ASSERT_TRUE(page.ok()) << page.error().text();
  const std::string& html = page.value();
  EXPECT_THAT(html, HasSubstr("<title>a &amp; &lt;b&gt;.lcmlog</title>"));
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;alert"));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
  EXPECT_THAT(html, Not(HasSubstr("@import")));
  EXPECT_THAT(html, Not(HasSubstr("<link")));
  // Outside of the namespaces of SVG nothing points to the network.
  EXPECT_THAT(std::regex_replace(html, std::regex("xmlns(:xlink)?=\"[^\"]*\""), ""), Not(HasSubstr("http://")));
  for (const auto& tag : truth.tags) EXPECT_THAT(html, HasSubstr(tag.epc.hex()));
}

TEST(Report, HasFourPlotsWhoseIdsDiffer) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const auto truth = winding_truth(400, 12);
  const std::string html = make_report(result_with_history(truth), truth, "r").value();
  std::multiset<std::string> ids;
  const std::regex id("\\sid=['\"]([^'\"]*)['\"]");
  for (std::sregex_iterator i(html.begin(), html.end(), id), end; i != end; ++i) ids.insert((*i)[1]);
  EXPECT_GT(ids.size(), 8u);
  for (const std::string& one : ids) EXPECT_EQ(ids.count(one), 1u) << one;
  std::size_t plots = 0;
  for (std::size_t at = 0; (at = html.find("<svg", at)) != std::string::npos; ++at) ++plots;
  EXPECT_EQ(plots, 4u);
  EXPECT_THAT(html, Not(HasSubstr("rgb(  1")));
}

TEST(Report, SaysSoWhereThereIsNothingToShow) {
  const auto page = make_report({}, std::nullopt, "empty");
  ASSERT_TRUE(page.ok()) << page.error().text();
  EXPECT_THAT(page.value(), HasSubstr("No path and no located tag."));
  EXPECT_THAT(page.value(), HasSubstr("The result holds no health report."));
}

TEST(Report, SameInputSamePage) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const auto truth = winding_truth(400, 12);
  const auto result = result_with_history(truth);
  EXPECT_EQ(make_report(result, truth, "r").value(), make_report(result, truth, "r").value());
}

}  // namespace
}  // namespace rfmvo::report
