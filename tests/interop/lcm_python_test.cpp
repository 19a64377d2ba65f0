// Other people's LCM tools on our logs: the Python package of lcm-proj with types from lcm-gen, and
// lcm-logplayer.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "edges/journal.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using testing::run_command;
using testing::TemporaryFolder;
using testing::write_file;

// Reads a log and prints, as JSON, what it decoded; then writes the same events to another log.
constexpr const char* kReadLog = R"(import json, sys
import lcm, rfmvo
types = {'START': rfmvo.start_t, 'FRAME': rfmvo.frame_t, 'CAMERA_POSE': rfmvo.camera_pose_t,
         'TAG_READ': rfmvo.tag_read_t, 'TICK': rfmvo.tick_t, 'FAULT': rfmvo.fault_t, 'COMMAND': rfmvo.command_t,
         'READER_STATUS': rfmvo.reader_status_t,
         'VO_POSE': rfmvo.camera_pose_t, 'TAG': rfmvo.tag_estimate_t, 'SCALE': rfmvo.scale_t,
         'METRIC_POSE': rfmvo.metric_pose_t, 'POSE': rfmvo.pose_t, 'TRAJECTORY': rfmvo.trajectory_t,
         'MAP_REVISION': rfmvo.map_revision_t, 'HEALTH': rfmvo.health_t}
out = {'channels': []}
copy = lcm.EventLog(sys.argv[2], 'w', overwrite=True)
for event in lcm.EventLog(sys.argv[1], 'r'):
    name = event.channel.removeprefix('RFMVO_')
    message = types[name].decode(event.data)
    assert message.utime == event.timestamp, name
    out['channels'].append(name)
    if name == 'TAG_READ':
        out['epc'] = message.epc.hex().upper()
        out['phase_q16'] = message.phase_q16
        out['rssi_cdbm'] = message.rssi_cdbm
    if name == 'TAG':
        out['hypotheses'] = [list(h.pos) for h in message.hypotheses]
    copy.write_event(event.timestamp, event.channel, message.encode())
copy.close()
print(json.dumps(out))
)";

class LcmPython : public ::testing::Test {
 protected:
  void SetUp() override {
    python_ = std::string(RFMVO_VENV) + "/bin/python3";
    if (run_command("'" + python_ + "' -c 'import lcm'").exit_code != 0)
      GTEST_SKIP() << "no Python lcm in " << RFMVO_VENV << " (cmake/install-packages.sh puts it there)";
    const auto generated =
        run_command("lcm-gen --python --ppath '" + (folder_ / "types") + "' " RFMVO_SOURCE_DIR "/lcm_types/rfmvo/*.lcm");
    ASSERT_EQ(generated.exit_code, 0) << generated.err;
    write_file(folder_ / "read_log.py", kReadLog);
  }
  // Our log by Python, its copy of our log by us.
  nlohmann::json read(const std::string& log) {
    const auto result = run_command("PYTHONPATH='" + (folder_ / "types") + "' '" + python_ + "' '" +
                                    (folder_ / "read_log.py") + "' '" + log + "' '" + copy_ + "'");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? nlohmann::json::parse(result.out) : nlohmann::json{};
  }
  TemporaryFolder folder_;
  std::string python_;
  std::string copy_ = folder_ / "copy.lcmlog";
};

TEST_F(LcmPython, ReadsOurJournalAndWritesItBackByteForByte) {
  testing::write_journal(folder_ / "run.lcmlog", testing::one_of_each_event());
  const nlohmann::json out = read(folder_ / "run.lcmlog");
  EXPECT_EQ(out.at("channels").size(), testing::one_of_each_event().size());
  EXPECT_EQ(out.at("epc"), "E28011602000600D3CA80AE1");
  EXPECT_EQ(out.at("phase_q16"), 65535);
  EXPECT_EQ(out.at("rssi_cdbm"), -5512);
  EXPECT_TRUE(testing::read_file(folder_ / "run.lcmlog") == testing::read_file(copy_));
}

TEST_F(LcmPython, ReadsOurResult) {
  auto writer = LogWriter::create(folder_ / "result.lcmlog", "RFMVO_");
  ASSERT_TRUE(writer.ok());
  for (const Estimate& estimate : testing::one_of_each_estimate()) ASSERT_TRUE(writer.value()->publish(estimate).ok());
  ASSERT_TRUE(writer.value()->close().ok());
  const nlohmann::json out = read(folder_ / "result.lcmlog");
  EXPECT_EQ(out.at("channels").size(), testing::one_of_each_estimate().size() + 1) << "POSE goes with METRIC_POSE";
  EXPECT_EQ(out.at("hypotheses").size(), 2u);
  const auto back = read_estimates(copy_, "RFMVO_");
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_EQ(back.value().size(), testing::one_of_each_estimate().size());
}

TEST(LcmLogplayer, PlaysOurJournal) {
  if (run_command("command -v lcm-logplayer").exit_code != 0) GTEST_SKIP() << "no lcm-logplayer (package liblcm-bin)";
  const TemporaryFolder folder;
  const auto events = testing::one_of_each_event();
  testing::write_journal(folder / "run.lcmlog", events);
  // Into another log instead of the network.
  const auto played = run_command("lcm-logplayer --lcm-url='file://" + (folder / "played.lcmlog") + "?mode=w' '" +
                                  (folder / "run.lcmlog") + "'");
  ASSERT_EQ(played.exit_code, 0) << played.err;
  auto reader = JournalReader::open(folder / "played.lcmlog", "RFMVO_", {});
  ASSERT_TRUE(reader.ok()) << reader.error().text();
  std::size_t count = 0;
  while (true) {
    const auto event = reader.value()->next();
    ASSERT_TRUE(event.ok()) << event.error().text();
    if (!event.value()) break;
    ++count;
  }
  EXPECT_EQ(count, events.size());
}

}  // namespace
}  // namespace rfmvo
