#include "report/report.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>

#include "report/gnuplot.hpp"
#include "report/html.hpp"
#include "support/evaluate_world.hpp"
#include "support/sample_events.hpp"

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

TEST(Report, HasFivePlotsWhoseIdsDiffer) {
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
  EXPECT_EQ(plots, 5u);
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

// Reads that the physics of a phase would give: what is taken off is all of it.
class Residuals : public ::testing::Test {
 protected:
  Residuals() {
    calibration_ = sample_calibration();
    last_ = evaluate::last_of(perfect_result(truth_));
    for (std::size_t k = 0; k < 400; ++k) {
      TagRead read;
      const auto& pose = truth_.trajectory[k];
      const auto& tag = truth_.tags[k % truth_.tags.size()];
      const auto& antenna = calibration_.antennas[k % 2];
      read.time = pose.time;
      read.epc = tag.epc;
      read.port = antenna.port;
      read.frequency_hz = static_cast<std::uint32_t>(920'625'000 + 500'000 * (k % 8));
      const double distance_m = (pose.T_W_C * antenna.p_C_A_m - tag.p_W_X_m).norm();
      const double cable_rad = (antenna.port == 1 ? 0.4 : -0.7) * 0.5 * static_cast<double>(k % 8);
      const double offset_rad = 0.3 * static_cast<double>(k % truth_.tags.size()) + antenna.port;
      read.phase =
          Phase::from_rad(4.0 * kPi * read.frequency_hz * distance_m / kSpeedOfLight_m_s + cable_rad + offset_rad);
      reads_.push_back(read);
    }
  }
  std::vector<ReadPoint> points() {
    std::vector<ReadPoint> all;
    for (const TagRead& read : reads_) all.push_back({read.time, read.epc, read.port, std::nullopt});
    add_residuals(reads_, calibration_, last_, all);
    return all;
  }
  simulate::Truth truth_ = winding_truth(400, 7);
  Calibration calibration_;
  evaluate::LastEstimates last_;
  std::vector<TagRead> reads_;
};

TEST_F(Residuals, AreNothingWhereTheSolutionIsTheTruth) {
  // The slope's step (0.01 rad/MHz) over half of 3.5 MHz.
  for (const ReadPoint& point : points()) {
    ASSERT_TRUE(point.residual_rad);
    EXPECT_NEAR(*point.residual_rad, 0.0, 0.02);
  }
}

TEST_F(Residuals, AreTheErrorThatWasPutIn) {
  std::vector<double> errors;
  for (std::size_t k = 0; k < reads_.size(); ++k) {
    errors.push_back(0.3 * std::sin(0.37 * static_cast<double>(k)));
    reads_[k].phase = Phase::from_rad(reads_[k].phase.rad() + errors[k]);
  }
  const auto all = points();
  double apart = 0.0, size = 0.0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    apart += std::pow(*all[k].residual_rad - errors[k], 2);
    size += errors[k] * errors[k];
  }
  EXPECT_LT(std::sqrt(apart / size), 0.2) << "but for the means of each tag and antenna";
}

TEST_F(Residuals, AreAbsentWithoutPathOrPosition) {
  reads_[5].time = reads_.back().time + Duration{1'000'000'000};
  last_.tags.at(reads_[6].epc).status = TagStatus::kTooFewReads;
  const auto all = points();
  EXPECT_FALSE(all[5].residual_rad);
  EXPECT_FALSE(all[6].residual_rad);
  EXPECT_TRUE(all[7].residual_rad);
}

TEST(Report, AJournalAddsReadsResidualsAndFaults) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const auto truth = winding_truth(100, 3);
  JournalData journal;
  journal.faults = {{frame_time(10), "reader", "<b>cable</b> pulled"}};
  for (int k = 0; k < 100; ++k) journal.reads.push_back({frame_time(k), epc_of(k % 3), 1, 0.01 * k});
  const std::string html = make_report(noisy_result(truth), std::nullopt, "r", journal).value();
  EXPECT_THAT(html, HasSubstr("<title>Reads over time</title>"));
  EXPECT_THAT(html, HasSubstr("<title>Phase residuals over time</title>"));
  EXPECT_THAT(html, HasSubstr("&lt;b&gt;cable&lt;/b&gt; pulled"));
  EXPECT_THAT(html, HasSubstr("over 100 reads"));
}

// What a browser must draw stays small: no line for each of so many tags.
TEST(Report, TwoThousandTagsStayBelowTenMegabytes) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  auto result = perfect_result(winding_truth(200, 2000));
  std::vector<Estimate> all;
  for (int second = 0; second < 60; ++second)
    for (Estimate estimate : result) {
      if (auto* tag = std::get_if<TagEstimate>(&estimate)) {
        tag->time = frame_time(25 * second);
        all.push_back(estimate);
      } else if (second == 0) {
        all.push_back(estimate);
      }
    }
  const std::string html = make_report(all, std::nullopt, "r").value();
  EXPECT_LT(html.size(), 10'000'000u);
}

}  // namespace
}  // namespace rfmvo::report
