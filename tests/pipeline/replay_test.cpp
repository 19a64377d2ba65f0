// Journal and replay through the built programs: same journal, same configuration, same bytes; and
// what goes wrong is said in one line.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "edges/journal.hpp"
#include "edges/lcm_codec.hpp"
#include "edges/log_file.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using testing::CommandResult;
using testing::read_file;
using testing::run_command;
using testing::TemporaryFolder;
using testing::write_file;

constexpr int kPoses = 60;  // 6 s

CommandResult rfmvo(const std::string& arguments) { return run_command(RFMVO_COMMAND " " + arguments); }
CommandResult rfmvod(const std::string& arguments) { return run_command(RFMVO_DAEMON " " + arguments); }

std::string in_quotes(const std::string& path) { return "'" + path + "'"; }

// One clear line on stderr that contains `culprit`; nothing but `left` remains in the folder.
void expect_one_line(const CommandResult& result, const std::string& culprit, int exit_code = 1) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(culprit), std::string::npos) << result.err << "does not name " << culprit;
}

class Replay : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { testing::write_journal(journal_, testing::short_run(kPoses)); }
  [[nodiscard]] std::string to(const std::string& result) const {
    return "replay " + in_quotes(journal_) + " --out " + in_quotes(folder_ / result) + " --estimator " + GetParam();
  }
  TemporaryFolder folder_;
  std::string journal_ = folder_ / "run.lcmlog";
};

INSTANTIATE_TEST_SUITE_P(Estimators, Replay, ::testing::Values("joint", "paper"));

TEST_P(Replay, TwoReplaysOfOneJournalAreByteIdentical) {
  ASSERT_EQ(rfmvo(to("a.lcmlog")).exit_code, 0);
  ASSERT_EQ(rfmvo(to("b.lcmlog")).exit_code, 0);
  const std::string a = read_file(folder_ / "a.lcmlog");
  EXPECT_FALSE(a.empty());
  EXPECT_TRUE(a == read_file(folder_ / "b.lcmlog"));
}

TEST_P(Replay, TheResultHoldsItsStartAndEstimates) {
  ASSERT_EQ(rfmvo(to("a.lcmlog") + " --set joint.knot_spacing_m=0.5").exit_code, 0);
  const auto summary = summarise_journal(folder_ / "a.lcmlog", LcmConfig{}.prefix);
  ASSERT_TRUE(summary.ok()) << summary.error().text();
  EXPECT_EQ(summary.value().events, 1u);
  EXPECT_EQ(summary.value().start.config.estimator.kind, GetParam());
  EXPECT_EQ(summary.value().start.config.joint.knot_spacing_m, 0.5);
  const auto estimates = read_estimates(folder_ / "a.lcmlog", LcmConfig{}.prefix);
  ASSERT_TRUE(estimates.ok()) << estimates.error().text();
  EXPECT_GT(estimates.value().size(), static_cast<std::size_t>(kPoses));
}

// The live run: rfmvod with a journal as its source. Its own journal, replayed, must give the same bits.
TEST_P(Replay, ALiveRunAndTheReplayOfItsJournalAreByteIdentical) {
  write_file(folder_ / "box.toml",
             "[camera]\nsource = \"journal:" + journal_ + "\"\n[estimator]\npose_source = \"poses\"\nkind = \"" +
                 GetParam() + "\"\n[lcm]\nurl = \"memq://\"\n[journal]\ndirectory = \"" + (folder_ / "logs") + "\"\n");
  const CommandResult live =
      rfmvod("--config " + in_quotes(folder_ / "box.toml") + " --result " + in_quotes(folder_ / "live.lcmlog"));
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const std::string recorded = folder_ / "logs/20231114T221320Z.lcmlog";
  const CommandResult replay =
      rfmvo("replay " + in_quotes(recorded) + " --out " + in_quotes(folder_ / "replay.lcmlog"));
  ASSERT_EQ(replay.exit_code, 0) << replay.err;
  const std::string live_bytes = read_file(folder_ / "live.lcmlog");
  EXPECT_FALSE(live_bytes.empty());
  EXPECT_TRUE(live_bytes == read_file(folder_ / "replay.lcmlog"));
}

TEST(Daemon, PublishesOnTheBusWhatItWritesToTheResult) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "run.lcmlog", testing::short_run(kPoses));
  write_file(folder / "box.toml", "[camera]\nsource = \"journal:" + (folder / "run.lcmlog") +
                                      "\"\n[estimator]\npose_source = \"poses\"\n[lcm]\nurl = \"file://" +
                                      (folder / "bus.lcmlog") + "?mode=w\"\n");
  const CommandResult live =
      rfmvod("--config " + in_quotes(folder / "box.toml") + " --result " + in_quotes(folder / "live.lcmlog"));
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const auto bus = LogFileReader::open(folder / "bus.lcmlog");
  const auto result = LogFileReader::open(folder / "live.lcmlog");
  ASSERT_TRUE(bus.ok() && result.ok());
  (void)result.value()->next();  // the Start
  std::size_t count = 0;
  while (true) {
    const auto published = bus.value()->next();
    const auto written = result.value()->next();
    ASSERT_TRUE(published.ok() && written.ok());
    ASSERT_EQ(published.value().has_value(), written.value().has_value());
    if (!written.value()) break;
    EXPECT_EQ(published.value()->channel, written.value()->channel);
    EXPECT_EQ(published.value()->data, written.value()->data);
    ++count;
  }
  EXPECT_GT(count, static_cast<std::size_t>(kPoses));
}

TEST(Daemon, AStopSignalEndsItWithAWholeJournal) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "run.lcmlog", testing::short_run(20000));
  write_file(folder / "box.toml",
             "[camera]\nsource = \"journal:" + (folder / "run.lcmlog") +
                 "\"\n[estimator]\npose_source = \"poses\"\nkind = \"paper\"\n[lcm]\nurl = \"memq://\"\n");
  // The daemon is told to stop as soon as its journal has begun to grow.
  const std::string logs = folder / "logs";
  const CommandResult live =
      run_command(RFMVO_DAEMON " --config " + in_quotes(folder / "box.toml") + " --journal " + in_quotes(logs) +
                  " & pid=$!; " + "while [ -z \"$(find " + in_quotes(logs) +
                  " -name '*.tmp' -size +0 2>/dev/null)\" ] && kill -0 $pid 2>/dev/null; do :; done; " +
                  "kill -TERM $pid; wait $pid");
  EXPECT_EQ(live.exit_code, 0) << live.err;
  const std::string path = logs + "/20231114T221320Z.lcmlog";
  const auto summary = summarise_journal(path, LcmConfig{}.prefix);
  ASSERT_TRUE(summary.ok()) << summary.error().text();
  EXPECT_FALSE(std::filesystem::exists(path + ".tmp"));
}

TEST(Daemon, SaysInOneLineWhatItCannotDo) {
  const TemporaryFolder folder;
  const auto with = [&](const std::string& toml) {
    write_file(folder / "box.toml", toml);
    return rfmvod("--config " + in_quotes(folder / "box.toml") + " --journal " + in_quotes(folder / "logs"));
  };
  expect_one_line(with("[camera]\nsource = \"webcam:0\"\n"), "camera.source: \"webcam:0\" is not supported");
  expect_one_line(with("[camera]\nsource = \"v4l2:/dev/video0\"\n"), "daemon.calibration: is not set; a camera needs");
  expect_one_line(with(""), "camera.source: is not set");
  expect_one_line(with("[camera]\nsorce = \"x\"\n"),
                  "box.toml:2: camera.sorce: unknown key; did you mean camera.source?");
  expect_one_line(with("[camera]\nsource = \"journal:/nowhere/run.lcmlog\"\n"), "/nowhere/run.lcmlog: no such file");
  expect_one_line(with("[camera]\nsource = \"images:/nowhere\"\n"), "/nowhere/calib.txt: no such file");
  expect_one_line(with("[daemon]\ncalibration = \"/nowhere/c.toml\"\n"), "/nowhere/c.toml: no such file");
  expect_one_line(rfmvod("--config /nowhere/box.toml"), "/nowhere/box.toml: no such file");
  expect_one_line(rfmvod(""), "--config", 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "logs"));
}

class BadInput : public ::testing::Test {
 protected:
  void SetUp() override { testing::write_journal(journal_, testing::short_run(5)); }
  // Replays and checks that no result was left behind.
  CommandResult replay(const std::string& journal, const std::string& more = "") {
    const auto before = folder_.names();
    CommandResult result =
        rfmvo("replay " + in_quotes(journal) + " --out " + in_quotes(folder_ / "result.lcmlog") + " " + more);
    EXPECT_EQ(folder_.names(), before);
    return result;
  }
  TemporaryFolder folder_;
  std::string journal_ = folder_ / "run.lcmlog";
};

TEST_F(BadInput, ATruncatedJournalIsNamedWithItsOffset) {
  const std::string whole = read_file(journal_);
  write_file(folder_ / "cut.lcmlog", whole.substr(0, whole.size() - 10));
  const CommandResult result = replay(folder_ / "cut.lcmlog");
  expect_one_line(result, folder_ / "cut.lcmlog: byte ");
  expect_one_line(result, "truncated");
}

TEST_F(BadInput, AForeignFileIsNamed) {
  write_file(folder_ / "notes.txt", "a text that is much longer than the header of a log");
  expect_one_line(replay(folder_ / "notes.txt"), folder_ / "notes.txt: byte 0: not an LCM log");
}

TEST_F(BadInput, ALogWithoutAStartIsNoJournal) {
  testing::write_journal(folder_ / "tick.lcmlog", {Tick{}});
  expect_one_line(replay(folder_ / "tick.lcmlog"), "tick.lcmlog: not a journal: it holds no RFMVO_START event");
}

TEST_F(BadInput, AMissingJournalIsNamed) {
  expect_one_line(replay("/nowhere/run.lcmlog"), "/nowhere/run.lcmlog: no such file");
}

TEST_F(BadInput, AnUnknownConfigurationKeyNamesLineAndNearestKey) {
  write_file(folder_ / "c.toml", "[joint]\nknot_spacing = 1\n");
  expect_one_line(replay(journal_, "--config " + in_quotes(folder_ / "c.toml")),
                  folder_ / "c.toml:2: joint.knot_spacing: unknown key; did you mean joint.knot_spacing_m?");
}

TEST_F(BadInput, AWrongUnitNamesKeyAndUnit) {
  write_file(folder_ / "c.toml", "[joint]\nknot_spacing_m = \"25 cm\"\n");
  expect_one_line(replay(journal_, "--config " + in_quotes(folder_ / "c.toml")),
                  "c.toml:2: joint.knot_spacing_m: expects a number in m, not the text \"25 cm\"");
  expect_one_line(replay(journal_, "--set 'joint.knot_spacing_m=25 cm'"), "expects a number in m", 2);
}

TEST_F(BadInput, AnUnwritableResultIsNamed) {
  expect_one_line(rfmvo("replay " + in_quotes(journal_) + " --out /nowhere/r.lcmlog"),
                  "/nowhere/r.lcmlog: cannot be written");
  expect_one_line(rfmvo("replay " + in_quotes(journal_) + " --out " + in_quotes(journal_)), "is the journal itself");
}

TEST_F(BadInput, AJournalWithoutFramesSaysThatItHasPoses) {
  expect_one_line(replay(journal_, "--from frames"), "run.lcmlog: holds no frames, but camera poses");
  testing::write_journal(folder_ / "frames.lcmlog", {testing::one_of_each_event()[0], testing::one_of_each_event()[1]});
  expect_one_line(replay(folder_ / "frames.lcmlog", "--from poses"),
                  "frames.lcmlog: holds no camera poses, but frames");
}

TEST_F(BadInput, AWrongCommandLineGivesTwo) {
  expect_one_line(replay(journal_, "--speed fast"), "--speed", 2);
  expect_one_line(replay(journal_, "--set joint=1"), "--set", 2);
  expect_one_line(replay(journal_, "--from wheels"), "--from", 2);
  expect_one_line(rfmvo("replay"), "required", 2);
  expect_one_line(rfmvo("dance"), "", 2);
}

TEST(ReplaySpeed, PacedReplayPublishesAndTakesItsTime) {
  const TemporaryFolder folder;
  testing::write_journal(folder / "run.lcmlog", testing::short_run(11));  // 1.2 s of events
  const std::string bus = "'lcm.url=file://" + (folder / "bus.lcmlog") + "?mode=w'";
  const CommandResult paced =
      rfmvo("replay " + in_quotes(folder / "run.lcmlog") + " --out " + in_quotes(folder / "a.lcmlog") +
            " --speed 4 --set " + bus + " --json " + in_quotes(folder / "a.json"));
  ASSERT_EQ(paced.exit_code, 0) << paced.err;
  const auto json = nlohmann::json::parse(read_file(folder / "a.json"));
  EXPECT_GE(json.at("wall_s").get<double>(), json.at("event_span_s").get<double>() / 4);
  EXPECT_EQ(json.at("events").get<int>(), 24);
  EXPECT_GT(json.at("realtime_factor").get<double>(), 0.0);
  const auto published = read_estimates(folder / "bus.lcmlog", LcmConfig{}.prefix);
  const auto written = read_estimates(folder / "a.lcmlog", LcmConfig{}.prefix);
  ASSERT_TRUE(published.ok() && written.ok());
  EXPECT_EQ(published.value().size(), written.value().size());
}

TEST(Command, VersionAndHelpAreNoErrors) {
  EXPECT_EQ(rfmvo("--version").exit_code, 0);
  EXPECT_EQ(rfmvo("--version").out.substr(0, 6), "rfmvo ");
  EXPECT_EQ(rfmvo("replay --help").exit_code, 0);
  EXPECT_EQ(rfmvod("--version").out.substr(0, 7), "rfmvod ");
}

}  // namespace
}  // namespace rfmvo
