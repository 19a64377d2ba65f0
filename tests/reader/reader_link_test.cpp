// The client against a simulated reader over loopback: a session, and everything that is known to go wrong.
#include "edges/llrp/reader_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "support/reader_bench.hpp"

namespace rfmvo {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ReaderBench;
using testing::sample_model;

// What the reader has reported is what came out: nothing lost, doubled or changed.
void expect_same(const std::vector<TagRead>& got, const std::vector<TagRead>& truth) {
  ASSERT_EQ(got.size(), truth.size());
  for (std::size_t k = 0; k < got.size(); ++k) {
    EXPECT_EQ(got[k].epc, truth[k].epc) << k;
    EXPECT_EQ(got[k].reader_time, truth[k].reader_time) << k;
    EXPECT_EQ(got[k].port, truth[k].port) << k;
    EXPECT_EQ(got[k].phase, truth[k].phase) << k;
    EXPECT_EQ(got[k].frequency_hz, truth[k].frequency_hz) << k;
    EXPECT_EQ(got[k].rssi_cdbm, truth[k].rssi_cdbm) << k;
    EXPECT_EQ(got[k].doppler_hz_q4, truth[k].doppler_hz_q4) << k;
    EXPECT_EQ(got[k].seen_count, truth[k].seen_count) << k;
  }
}

TEST(ReaderLink, DeliversEveryReadAsTheReaderReportedIt) {
  ReaderBench bench(sample_model(1000, 0.002));
  bench.run(3.0);
  EXPECT_THAT(bench.faults(), IsEmpty());
  const auto reads = bench.all<TagRead>();
  EXPECT_EQ(reads.size(), 1000u);
  expect_same(reads, bench.server->reader().reported());
  for (const TagRead& read : reads) {
    // The bench's clock turns by 10 ms between reports.
    EXPECT_NEAR((read.time - DeviceTime{read.reader_time.ns}).seconds(), 0.005, 0.006);
  }
}

TEST(ReaderLink, LosesNothingWhenItGetsNoTimeForAMinute) {
  ReaderBench bench(sample_model(60'000, 0.001));
  ASSERT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 1.0));
  for (int step = 0; step < 300; ++step) {
    bench.now = bench.now + Duration::from_seconds(0.2);
    bench.server->poll(Duration{0});
  }
  bench.run(1.0);
  expect_same(bench.all<TagRead>(), bench.server->reader().reported());
  EXPECT_EQ(bench.server->reader().reported().size(), 60'000u);
  EXPECT_EQ(bench.all<ReaderStatus>().back().connections, 1u) << "what waits in the socket is a sign of life";
}

TEST(ReaderLink, LeavesTheReaderAsItFoundIt) {
  ReaderBench bench(sample_model());
  ASSERT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 1.0));
  EXPECT_TRUE(bench.server->reader().active());
  // stop() waits on the real socket: serve it from here until it has said goodbye.
  std::thread stopper([&] { bench.link->stop(); });
  while (bench.server->connections() > 0) bench.server->poll(Duration{1'000'000});
  stopper.join();
  EXPECT_TRUE(bench.link->session().stopped());
  EXPECT_FALSE(bench.server->reader().active());
}

TEST(ReaderLink, UnderstandsFramesThatAreCutAnywhere) {
  for (const std::size_t chunk : {1, 7, 64}) {
    ReaderBench bench(sample_model(20, 0.01), {chunk, Duration{0}, {}});
    bench.run(1.0);
    EXPECT_THAT(bench.faults(), IsEmpty()) << chunk;
    expect_same(bench.all<TagRead>(), bench.server->reader().reported());
    EXPECT_EQ(bench.all<TagRead>().size(), 20u);
  }
}

// One byte every 0.2 s: no deadline is extended by that.
TEST(ReaderLink, GivesUpOnAPeerThatDripFeeds) {
  ReaderBench bench(sample_model(), {1, Duration{200'000'000}, {}});
  EXPECT_TRUE(bench.run_until([&] { return !bench.faults().empty(); }, 11.0, 0.05));
  EXPECT_THAT(bench.faults(), ElementsAre(HasSubstr("a frame has not come to its end within 5 s")));
}

TEST(ReaderLink, ComesBackAfterAResetInMidFrame) {
  ReaderBench bench(sample_model(300, 0.01), {0, Duration{0}, std::size_t{3000}});
  EXPECT_TRUE(bench.run_until([&] { return !bench.faults().empty(); }, 3.0));
  EXPECT_THAT(bench.faults(), ElementsAre(HasSubstr("the connection is lost")));
  const std::size_t before = bench.all<TagRead>().size();
  EXPECT_TRUE(bench.run_until([&] { return bench.all<TagRead>().size() > before; }, 3.0)) << "within 3 s";
}

TEST(ReaderLink, NoticesAReaderThatFallsSilentWithinThreeKeepalives) {
  auto model = sample_model(1000, 0.01);
  model.troubles.silent_after_s = 1.0;
  ReaderBench bench(std::move(model));
  ASSERT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 1.0));
  bench.run(1.0);
  EXPECT_THAT(bench.faults(), IsEmpty());
  EXPECT_TRUE(bench.run_until([&] { return !bench.faults().empty(); }, 3.1));
  EXPECT_THAT(bench.faults(), ElementsAre("the reader has been silent for three keepalives"));
}

TEST(ReaderLink, TakesReportsForASignOfLifeWhereKeepalivesAreMissing) {
  auto model = sample_model(1000, 0.01);
  model.troubles.no_keepalives = true;
  ReaderBench bench(std::move(model));
  bench.run(9.0);
  EXPECT_THAT(bench.faults(), IsEmpty());
  bench.run(5.0);  // no more reads
  EXPECT_THAT(bench.faults(), ElementsAre("the reader has been silent for three keepalives"));
}

TEST(ReaderLink, KeepsAConnectionOnWhichNoTagIsRead) {
  ReaderBench bench(sample_model(0));
  bench.run(30.0, 0.05);
  EXPECT_THAT(bench.faults(), IsEmpty());
  EXPECT_TRUE(bench.link->session().reading());
}

TEST(ReaderLink, WaitsForAReaderThatAnotherClientHolds) {
  ReaderBench bench(sample_model());
  llrp::ReaderSettings settings;
  settings.host = "127.0.0.1";
  settings.port = bench.server->port();
  auto other = bench.make_link(settings);
  std::swap(other, bench.link);  // the first one connects ...
  ASSERT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 1.0));
  std::vector<Event> seen;
  std::swap(other, bench.link);  // ... and the second is refused
  bench.events.clear();
  const auto both = [&](double s) {
    for (double t = 0.0; t < s; t += 0.02) {
      bench.run(0.02, 0.02);
      if (!other) continue;
      for (Event& event : other->poll(Duration{0})) seen.push_back(std::move(event));
    }
  };
  both(3.0);
  EXPECT_THAT(bench.faults(), ElementsAre("another client is connected to the reader"));
  EXPECT_FALSE(bench.link->session().reading());
  const bool told = std::any_of(seen.begin(), seen.end(), [](const Event& e) {
    const auto* fault = std::get_if<Fault>(&e);
    return fault != nullptr && fault->text.find("another client has tried to connect") != std::string::npos;
  });
  EXPECT_TRUE(told) << "the first one hears of it";
  other.reset();
  EXPECT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 3.0)) << "within 3 s";
}

TEST(ReaderLink, ComesBackWithinThreeSecondsAfterAReboot) {
  auto model = sample_model(100000, 0.01);
  ReaderBench bench(std::move(model));
  ASSERT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 1.0));
  bench.run(1.0);
  bench.server->reboot();
  EXPECT_FALSE(bench.server->reader().active());
  ASSERT_TRUE(bench.run_until([&] { return !bench.link->session().reading(); }, 1.0));
  EXPECT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 3.0));
  bench.run(1.0);
  expect_same(bench.all<TagRead>(), bench.server->reader().reported());
  EXPECT_EQ(bench.all<ReaderStatus>().back().connections, 2u);
}

TEST(ReaderLink, ComesBackWithinThreeSecondsAfterTheCableWasOutForAMinute) {
  ReaderBench bench(sample_model(100000, 0.01));
  ASSERT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 1.0));
  bench.server->pull_the_plug();
  bench.run(60.0, 0.05);
  EXPECT_FALSE(bench.link->session().reading());
  EXPECT_LE(bench.faults().size(), 4u) << "the same fault is not repeated at every attempt";
  ASSERT_TRUE(bench.server->plug_in().ok());
  EXPECT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 3.0));
}

TEST(ReaderLink, PlacesReadsOfAReaderThatBelievesInTheYear2000) {
  auto model = sample_model(500, 0.01);
  model.troubles.year_2000 = true;
  ReaderBench bench(std::move(model));
  bench.run(6.0);
  const auto reads = bench.all<TagRead>();
  ASSERT_EQ(reads.size(), 500u);
  EXPECT_NEAR(reads[0].reader_time.us() * 1e-6, 946'684'800.0, 5.0);
  // Reads come 10 ms apart; the first began 10 ms after the start, which the bench's clock knows to 10 ms.
  EXPECT_NEAR((reads.back().time - reads.front().time).seconds(), 4.99, 0.02);
  const ReaderStatus status = bench.all<ReaderStatus>().back();
  EXPECT_TRUE(status.clock_known);
  EXPECT_NEAR(status.clock_offset_s, 1'767'225'600.0 - 946'684'800.0, 1.0);
  EXPECT_THAT(bench.faults(), IsEmpty());
}

TEST(ReaderLink, PlacesReadsOfAReaderThatHasNoClock) {
  auto model = sample_model(500, 0.01);
  model.troubles.uptime_only = true;
  ReaderBench bench(std::move(model));
  bench.run(6.0);
  const auto reads = bench.all<TagRead>();
  ASSERT_EQ(reads.size(), 500u);
  EXPECT_LT(reads[0].reader_time.us(), 5'000'000);
  EXPECT_NEAR((reads.back().time - reads.front().time).seconds(), 4.99, 0.02);
  EXPECT_NEAR((reads.back().time - bench.now).seconds(), -1.0, 0.1);
}

TEST(ReaderLink, MarksReportsThatSumSeveralSingulations) {
  auto model = sample_model(90, 0.01);
  model.troubles.accumulate = 3;
  ReaderBench bench(std::move(model));
  bench.run(2.0);
  const auto reads = bench.all<TagRead>();
  ASSERT_FALSE(reads.empty());
  for (const TagRead& read : reads) EXPECT_EQ(read.seen_count, 3);
  expect_same(reads, bench.server->reader().reported());
}

TEST(ReaderLink, FillsInWhatTheReaderOmits) {
  auto model = sample_model(90, 0.01);
  model.troubles.omit_unchanged = true;
  for (TagRead& read : model.reads) read.port = 2;
  ReaderBench bench(std::move(model));
  bench.run(2.0);
  EXPECT_EQ(bench.all<TagRead>().size(), 90u);
  expect_same(bench.all<TagRead>(), bench.server->reader().reported());
}

TEST(ReaderLink, TakesEpcsOf128Bits) {
  auto model = sample_model(10, 0.01);
  model.troubles.long_epc = true;
  ReaderBench bench(std::move(model));
  bench.run(1.0);
  ASSERT_EQ(bench.all<TagRead>().size(), 10u);
  EXPECT_EQ(bench.all<TagRead>()[0].epc.hex(), "3074257BF7194E4000001A85ABCDEF01");
}

TEST(ReaderLink, TellsOfALostAntennaAndOfAnOverflow) {
  auto model = sample_model(300, 0.01);
  model.troubles.antenna_lost_after_s = 1.0;
  model.troubles.overflow_after_s = 1.5;
  ReaderBench bench(std::move(model));
  bench.run(4.0);
  EXPECT_THAT(bench.faults(),
              ElementsAre("antenna 1 is disconnected", "the reader's buffer has overflowed: reports are lost"));
  expect_same(bench.all<TagRead>(), bench.server->reader().reported());
}

TEST(ReaderLink, NamesWhatTheReaderCannotDo) {
  const auto fault_with = [](llrp::ReaderSettings settings, reader_sim::ReaderModel model = sample_model()) {
    ReaderBench bench(std::move(model), {}, settings);
    bench.run(1.0);
    EXPECT_FALSE(bench.link->session().reading());
    return bench.faults().empty() ? "" : bench.faults()[0];
  };
  llrp::ReaderSettings settings;
  settings.antennas = {1, 5};
  EXPECT_EQ(fault_with(settings), "reader.antennas: the reader has no antenna port 5, but 4 ports");
  settings = {};
  settings.mode = 17;
  EXPECT_EQ(fault_with(settings), "reader.mode: the reader has no mode 17; it has 0 1 2 3 4 1000 1002 1003 1004");
  settings = {};
  settings.power_dbm = 5.0;
  EXPECT_EQ(fault_with(settings), "reader.power_dbm: the reader cannot send with so little power");
  auto model = sample_model();
  model.channels_khz[1] = 2'293'250;
  EXPECT_THAT(fault_with({}, model), HasSubstr("a channel of 2293250 kHz is outside 840 to 960 MHz"));
  model = sample_model();
  model.troubles.no_phase = true;
  EXPECT_EQ(fault_with({}, model), "CUSTOM_MESSAGE: M_UnsupportedMessage: Unsupported message");
}

TEST(ReaderLink, ReadsOnlyTheAntennasItWasToldTo) {
  llrp::ReaderSettings settings;
  settings.antennas = {2};
  ReaderBench bench(sample_model(100, 0.01), {}, settings);
  bench.run(2.0);
  ASSERT_EQ(bench.all<TagRead>().size(), 50u);
  for (const TagRead& read : bench.all<TagRead>()) EXPECT_EQ(read.port, 2);
}

TEST(ReaderLink, SaysWhyAReaderIsNotThere) {
  ReaderBench bench(sample_model());
  bench.server->pull_the_plug();
  bench.run(1.0);
  EXPECT_THAT(bench.faults(), ElementsAre("cannot be reached: Connection refused"));
}

TEST(ReaderLink, LeaksNoFileDescriptorOverManyConnections) {
  const auto open_fds = [] {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) ++count;
    return count;
  };
  const std::size_t before = open_fds();
  {
    ReaderBench bench(sample_model(100000, 0.01));
    for (int round = 0; round < 20; ++round) {
      ASSERT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 4.0));
      const std::size_t during = open_fds();
      EXPECT_LE(during, before + 8) << round;
      bench.server->reboot();
      bench.run(0.05);
    }
  }
  EXPECT_EQ(open_fds(), before);
}

TEST(ReaderLink, WorksOverIPv6) {
  reader_sim::ServerSettings server;
  server.host = "::1";
  if (!net::listen_on("::1", 0).ok()) GTEST_SKIP() << "this machine has no IPv6";
  ReaderBench bench(sample_model(10, 0.01), {}, {}, server);
  bench.run(1.0);
  EXPECT_EQ(bench.all<TagRead>().size(), 10u);
}

}  // namespace
}  // namespace rfmvo
