// rfmvod as a service: what systemd hears, what signals do. Its camera is one that is not there, so that it runs until
// it is told to stop.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <set>

#include "edges/journal.hpp"
#include "edges/log_file.hpp"
#include "edges/net/fd.hpp"
#include "edges/toml_files.hpp"
#include "rfmvo/box_status_t.hpp"
#include "support/running_daemon.hpp"

namespace rfmvo {
namespace {

using ::testing::HasSubstr;
using testing::RunningDaemon;
using testing::TemporaryFolder;
using testing::write_file;

class Systemd {
 public:
  explicit Systemd(std::string path) : path_(std::move(path)), fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof(address.sun_path) - 1);
    EXPECT_EQ(::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    const timeval patience{60, 0};
    (void)::setsockopt(fd_.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  }
  // The next message that begins so; empty: none came.
  std::string next(const std::string& begin) {
    while (true) {
      std::array<char, 1024> text{};
      const ssize_t got = ::recv(fd_.get(), text.data(), text.size(), 0);
      if (got < 0) return "";
      const std::string message(text.data(), static_cast<std::size_t>(got));
      if (message.starts_with(begin)) return message;
    }
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  net::Fd fd_;
};

struct BoxDaemon : ::testing::Test {
  BoxDaemon() {
    write_file(folder / "calibration.toml", to_toml(testing::sample_calibration()));
    write_config("");
  }
  void write_config(const std::string& more) const {
    write_file(folder / "box.toml", "[camera]\nsource = \"v4l2:/dev/rfmvo-no-camera\"\n[daemon]\ncalibration = \"" +
                                        (folder / "calibration.toml") + "\"\n[lcm]\nurl = \"file://" +
                                        (folder / "bus.lcmlog") + "?mode=w\"\n" + more);
  }
  std::unique_ptr<RunningDaemon> start() {
    return std::make_unique<RunningDaemon>(
        RFMVO_DAEMON, std::vector<std::string>{"--config", folder / "box.toml", "--journal", folder / "logs"},
        folder / "log",
        std::vector<std::pair<std::string, std::string>>{{"NOTIFY_SOCKET", systemd.path()},
                                                         {"WATCHDOG_USEC", "2000000"}});
  }
  // All events of all journals that it left.
  std::vector<Event> journalled() const {
    std::vector<Event> events;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "logs")) {
      auto reader = JournalReader::open(entry.path().string(), LcmConfig{}.prefix, {});
      EXPECT_TRUE(reader.ok());
      for (auto next = reader.value()->next(); next.ok() && next.value(); next = reader.value()->next())
        events.push_back(*next.value());
    }
    return events;
  }
  template <class Kind>
  std::vector<Kind> journalled_only() const {
    std::vector<Kind> kept;
    for (const Event& event : journalled())
      if (const auto* one = std::get_if<Kind>(&event)) kept.push_back(*one);
    return kept;
  }

  TemporaryFolder folder;
  Systemd systemd{folder / "notify"};
};

TEST_F(BoxDaemon, TellsSystemdThatItLivesAndRunsWithoutItsCamera) {
  auto daemon = start();
  EXPECT_EQ(systemd.next("READY=1"), "READY=1\nSTATUS=running on v4l2:/dev/rfmvo-no-camera");
  EXPECT_EQ(systemd.next("WATCHDOG=1"), "WATCHDOG=1");
  EXPECT_THAT(systemd.next("STATUS="), HasSubstr("0 frames/s, 0 reads/s, odometry initialising"));
  daemon->signal(SIGTERM);
  EXPECT_EQ(systemd.next("STOPPING=1"), "STOPPING=1");
  EXPECT_EQ(daemon->wait(), 0) << daemon->log();
  EXPECT_THAT(daemon->log(), HasSubstr("camera: /dev/rfmvo-no-camera: no such camera"));
  const auto faults = journalled_only<Fault>();
  ASSERT_EQ(faults.size(), 1u) << "told once, in the journal too";
  EXPECT_EQ(faults[0].text, "/dev/rfmvo-no-camera: no such camera");
  EXPECT_EQ(journalled_only<Start>().size(), 1u);
}

TEST_F(BoxDaemon, PublishesItsStatus) {
  auto daemon = start();
  EXPECT_NE(systemd.next("STATUS="), "");
  EXPECT_NE(systemd.next("STATUS="), "");
  daemon->signal(SIGTERM);
  ASSERT_EQ(daemon->wait(), 0) << daemon->log();
  auto bus = LogFileReader::open(folder / "bus.lcmlog");
  ASSERT_TRUE(bus.ok());
  int count = 0;
  box_status_t status{};
  for (auto record = bus.value()->next(); record.ok() && record.value(); record = bus.value()->next())
    if (record.value()->channel == "RFMVO_BOX") {
      ASSERT_GT(status.decode(record.value()->data.data(), 0, static_cast<int>(record.value()->data.size())), 0);
      ++count;
    }
  EXPECT_GE(count, 2);
  EXPECT_FALSE(status.camera_running);
  EXPECT_EQ(status.fault_count, 1);
  EXPECT_GT(status.memory_bytes, 1'000'000);
  EXPECT_GT(status.disk_free_bytes, 0);
}

TEST_F(BoxDaemon, AReloadChangesWhatCanChangeLiveAndIsJournalled) {
  auto daemon = start();
  EXPECT_NE(systemd.next("READY=1"), "");
  write_config("[estimator]\npublish_interval_s = 0.25\n");
  daemon->signal(SIGHUP);
  EXPECT_NE(systemd.next("RELOADING=1"), "");
  EXPECT_NE(systemd.next("READY=1"), "");
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(), 0);
  const auto commands = journalled_only<Command>();
  ASSERT_EQ(commands.size(), 1u) << daemon->log();
  EXPECT_EQ(commands[0].key, "estimator.publish_interval_s");
  EXPECT_EQ(commands[0].value, "0.25");
  EXPECT_EQ(journalled_only<Start>().size(), 1u) << "still the same run";
}

TEST_F(BoxDaemon, AReloadThatChangesMoreBeginsANewRun) {
  auto daemon = start();
  EXPECT_NE(systemd.next("READY=1"), "");
  write_config("[estimator]\nkind = \"paper\"\n");
  daemon->signal(SIGHUP);
  ASSERT_TRUE(daemon->says("a new run with the new configuration")) << daemon->log();
  EXPECT_NE(systemd.next("RELOADING=1"), "");
  EXPECT_NE(systemd.next("READY=1"), "") << "of the reload";
  EXPECT_NE(systemd.next("READY=1"), "") << "of the new run";
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(), 0);
  std::multiset<std::string> kinds;
  for (const Start& start : journalled_only<Start>()) kinds.insert(start.config.estimator.kind);
  EXPECT_EQ(kinds, (std::multiset<std::string>{"joint", "paper"}));
}

TEST_F(BoxDaemon, AWrongConfigurationIsAFaultAndChangesNothing) {
  auto daemon = start();
  EXPECT_NE(systemd.next("READY=1"), "");
  write_config("[estimator]\nkind = \"astrology\"\n");
  daemon->signal(SIGHUP);
  ASSERT_TRUE(daemon->says("the configuration stays as it is")) << daemon->log();
  EXPECT_TRUE(daemon->is_running());
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(), 0);
  bool told = false;
  for (const Fault& fault : journalled_only<Fault>()) told = told || fault.source == "configuration";
  EXPECT_TRUE(told);
}

TEST_F(BoxDaemon, ANewConfigurationThatNoRunCanBeginWithGivesWayToTheOldOne) {
  auto daemon = start();
  EXPECT_NE(systemd.next("READY=1"), "");
  write_config("[reader]\naddress = \"127.0.0.1\"\nantennas = \"none\"\n");
  daemon->signal(SIGHUP);
  ASSERT_TRUE(daemon->says("back to the configuration before")) << daemon->log();
  EXPECT_NE(systemd.next("RELOADING=1"), "");
  EXPECT_NE(systemd.next("READY=1"), "") << "of the reload";
  EXPECT_NE(systemd.next("READY=1"), "") << "of the run that goes on as before";
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(), 0) << daemon->log();
}

TEST_F(BoxDaemon, SettingsLieOverTheConfigurationAndTheCommandLineOverBoth) {
  write_file(folder / "settings.toml", "[camera]\nflip = \"both\"\ngain = 2\n");
  const auto ran = testing::run_command(RFMVO_DAEMON " --print-config --config '" + (folder / "box.toml") +
                                        "' --settings '" + (folder / "settings.toml") + "' --set camera.gain=3");
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  const auto printed = parse_config(ran.out, "printed");
  ASSERT_TRUE(printed.ok()) << printed.error().text();
  EXPECT_EQ(printed.value().camera.flip, "both");
  EXPECT_EQ(printed.value().camera.gain, 3.0);
  EXPECT_EQ(printed.value().camera.source, "v4l2:/dev/rfmvo-no-camera");
}

TEST_F(BoxDaemon, TheSelfTestSaysWhatIsWrongAndItsExitCodeToo) {
  const auto ran = testing::run_command(RFMVO_DAEMON " --self-test --config '" + (folder / "box.toml") + "'");
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_THAT(ran.out, HasSubstr("camera   WRONG  /dev/rfmvo-no-camera: no such camera\n"));
  EXPECT_THAT(ran.out, HasSubstr("reader   ok     none\n"));
}

}  // namespace
}  // namespace rfmvo
