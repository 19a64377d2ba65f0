// What a box tells: systemd, its status, its self-test.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cstring>

#include "edges/box/box_monitor.hpp"
#include "edges/box/latency_window.hpp"
#include "edges/box/machine.hpp"
#include "edges/box/self_test.hpp"
#include "edges/box/service_notify.hpp"
#include "edges/net/tcp.hpp"
#include "rfmvo/box_status_t.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr std::int64_t kSecond = 1'000'000'000;

// Systemd's end of the socket.
class Listener {
 public:
  explicit Listener(const std::string& path) : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    if (path.front() == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
    EXPECT_EQ(::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&address), size), 0);
  }
  std::string take() {
    std::array<char, 1024> text{};
    const ssize_t got = ::recv(fd_.get(), text.data(), text.size(), 0);
    return got < 0 ? "" : std::string(text.data(), static_cast<std::size_t>(got));
  }

 private:
  net::Fd fd_;
};

TEST(ServiceNotify, SpeaksToSystemd) {
  const TemporaryFolder folder;
  for (const std::string& path : {folder / "notify", "@rfmvo-test-" + std::to_string(::getpid())}) {
    Listener systemd(path);
    const ServiceNotify notify(path, Duration{kSecond});
    notify.ready("two\nlines");
    EXPECT_EQ(systemd.take(), "READY=1\nSTATUS=two lines");
    notify.alive();
    EXPECT_EQ(systemd.take(), "WATCHDOG=1");
    notify.reloading();
    EXPECT_THAT(systemd.take(), ::testing::StartsWith("RELOADING=1\nMONOTONIC_USEC="));
    notify.stopping();
    EXPECT_EQ(systemd.take(), "STOPPING=1");
  }
}

TEST(ServiceNotify, WithoutSystemdNothingHappens) {
  for (const std::string& path : {std::string(), std::string("/nowhere/notify"), std::string(4000, 'x')}) {
    const ServiceNotify notify(path, std::nullopt);
    notify.ready("");
    notify.alive();
    EXPECT_FALSE(notify.watchdog());
  }
}

TEST(ServiceNotify, NeverWaitsForASystemdThatDoesNotListen) {
  const TemporaryFolder folder;
  Listener systemd(folder / "notify");
  const ServiceNotify notify(folder / "notify", std::nullopt);
  for (int k = 0; k < 10'000; ++k) notify.alive();  // the socket is full long before
  EXPECT_EQ(systemd.take(), "WATCHDOG=1");
}

TEST(LatencyWindow, PercentilesAreOfWhatWasAdded) {
  LatencyWindow window;
  EXPECT_EQ(window.percentile(0.5), Duration{0});
  for (std::int64_t k = 100; k >= 1; --k) window.add(Duration{k});
  EXPECT_EQ(window.percentile(0.5), Duration{50});
  EXPECT_EQ(window.percentile(0.99), Duration{99});
  EXPECT_EQ(window.percentile(1.0), Duration{100});
  EXPECT_EQ(window.percentile(0.0), Duration{1});
  window.clear();
  EXPECT_EQ(window.percentile(1.0), Duration{0});
}

TEST(Machine, ReadsTheHottestZoneAndSurvivesBrokenOnes) {
  const TemporaryFolder folder;
  EXPECT_EQ(temperature_c(folder / "absent"), std::nullopt);
  testing::write_file(folder / "thermal_zone0/temp", "41250\n");
  testing::write_file(folder / "thermal_zone1/temp", "67500\n");
  testing::write_file(folder / "thermal_zone2/temp", "broken\n");
  testing::write_file(folder / "cooling_device0/type", "fan\n");
  EXPECT_EQ(temperature_c(folder / ""), 67.5);
}

TEST(Machine, KnowsItsDiskMemoryAndProcessor) {
  const TemporaryFolder folder;
  EXPECT_GT(disk_free_bytes(folder / "").value_or(0), 0);
  EXPECT_EQ(disk_free_bytes("/nowhere/at/all"), std::nullopt);
  EXPECT_EQ(disk_free_bytes(""), std::nullopt);
  EXPECT_GT(resident_bytes(), 100'000);
  EXPECT_GT(cpu_time().ns, 0);
}

box_status_t decoded(const LcmMessage& message) {
  box_status_t status;
  EXPECT_EQ(status.decode(message.data.data(), 0, static_cast<int>(message.data.size())),
            static_cast<int>(message.data.size()));
  return status;
}

TEST(BoxMonitor, RatesAreOfThePeriodAndCountersOfTheRun) {
  const DeviceTime start{1'700'000'000 * kSecond};
  BoxMonitor monitor(start, "RFMVO_");
  EXPECT_FALSE(monitor.is_due(start + Duration{kSecond - 1}));
  EXPECT_TRUE(monitor.is_due(start + Duration{kSecond}));
  for (int k = 0; k < 60; ++k) monitor.on_event(Frame{});
  for (int k = 0; k < 1000; ++k) monitor.on_event(TagRead{});
  for (int k = 1; k <= 10; ++k) monitor.on_delay(Duration{k * 1'000'000});
  BoxReadings readings;
  readings.cpu_time = Duration{kSecond / 2};
  readings.live.frames_dropped = 7;
  readings.frames_lost = 3;
  readings.journal.lost = {4, 5};
  readings.temperature_c = 55.5;
  const LcmMessage message = monitor.status(start + Duration{2 * kSecond}, readings);
  EXPECT_EQ(message.channel, "RFMVO_BOX");
  const box_status_t status = decoded(message);
  EXPECT_DOUBLE_EQ(status.frames_hz, 30.0);
  EXPECT_DOUBLE_EQ(status.reads_hz, 500.0);
  EXPECT_DOUBLE_EQ(status.cpu_share, 0.25);
  EXPECT_DOUBLE_EQ(status.delay_p99_s, 0.010);
  EXPECT_DOUBLE_EQ(status.temperature_c, 55.5);
  EXPECT_EQ(status.frames_dropped, 7);
  EXPECT_EQ(status.frames_lost, 3);
  EXPECT_EQ(status.journal_frames_lost, 4);
  EXPECT_EQ(status.journal_others_lost, 5);
  const box_status_t later = decoded(monitor.status(start + Duration{3 * kSecond}, readings));
  EXPECT_EQ(later.frames_hz, 0.0);
  EXPECT_EQ(later.frames, 60);
  EXPECT_EQ(later.delay_max_s, 0.0);
}

TEST(BoxMonitor, TellsTheLastFaultsAndTheReadersClock) {
  BoxMonitor monitor(DeviceTime{}, "RFMVO_");
  for (int k = 0; k < 20; ++k) monitor.on_event(Fault{DeviceTime{}, "camera", std::to_string(k)});
  ReaderStatus reader;
  reader.time = DeviceTime::from_us(5);
  reader.clock_offset_s = 12.5;
  reader.clock_sigma_s = 3e-4;
  monitor.on_event(reader);
  CameraPose pose;
  pose.status = VoStatus::kLost;
  monitor.on_estimate(pose);
  const box_status_t status = decoded(monitor.status(DeviceTime{kSecond}, {}));
  EXPECT_EQ(status.fault_count, 20);
  ASSERT_EQ(status.recent_faults, 8);
  EXPECT_EQ(status.faults.back(), "camera: 19");
  EXPECT_EQ(status.faults.front(), "camera: 12");
  EXPECT_EQ(status.reader.clock_offset_s, 12.5);
  EXPECT_EQ(status.reader.clock_sigma_s, 3e-4);
  EXPECT_EQ(status.vo_status, 3);
  EXPECT_THAT(monitor.text(), HasSubstr("odometry lost"));
}

TEST(SelfTest, SaysInWordsWhatIsWrong) {
  EXPECT_EQ(check_clock({0, false}).text, "nobody has set it: it says 1970-01-01 00:00 UTC");
  EXPECT_FALSE(check_clock({0, false}).ok);
  EXPECT_TRUE(check_clock({1'800'000'000, false}).ok);
  EXPECT_EQ(check_clock({1'800'000'000, true}).text, "set by a time server");

  CameraConfig camera;
  EXPECT_EQ(check_camera(camera).text, "camera.source is not set");
  camera.source = "v4l2:/dev/no-such-camera";
  EXPECT_EQ(check_camera(camera).text, "/dev/no-such-camera: no such camera");
  EXPECT_FALSE(check_camera(camera).ok);
  camera.source = "v4l2:/dev/null";
  EXPECT_THAT(check_camera(camera).text, HasSubstr("/dev/null: not a V4L2 device"));

  LcmConfig bus;
  bus.url = "udpm://10.0.0.1:7667";
  EXPECT_THAT(check_bus(bus).text, HasSubstr("not a multicast address"));
  bus.url = "memq://";
  EXPECT_TRUE(check_bus(bus).ok);

  JournalConfig journal;
  EXPECT_TRUE(check_journal(journal).ok);
  journal.directory = "/proc/nothing";
  EXPECT_EQ(check_journal(journal).text, "/proc/nothing: cannot be written");
}

TEST(SelfTest, TellsAReaderThatRefusesFromOneThatListens) {
  ReaderConfig reader;
  EXPECT_TRUE(check_reader(reader).ok) << "none is configured";
  reader.address = "127.0.0.1";
  {
    auto listener = net::listen_on("127.0.0.1", 0);
    ASSERT_TRUE(listener.ok());
    reader.port = net::port_of(listener.value());
    EXPECT_TRUE(check_reader(reader).ok) << check_reader(reader).text;
  }
  const Check refused = check_reader(reader);
  EXPECT_FALSE(refused.ok);
  EXPECT_EQ(refused.text, "127.0.0.1 port " + std::to_string(reader.port) + ": Connection refused");
}

}  // namespace
}  // namespace rfmvo
