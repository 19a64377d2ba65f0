// `rfmvo reader-sim` as a program: what it reports is what it writes as the truth, and is of the scene.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <thread>

#include "edges/llrp/reader_link.hpp"
#include "support/reader_bench.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using testing::read_file;
using testing::run_command;
using testing::TemporaryFolder;

TEST(ReaderSimCommand, ReportsTheSceneAndWritesTheTruthOfIt) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", truth = folder / "truth.csv";
  FILE* simulator = ::popen((RFMVO_COMMAND " reader-sim --scene S3 --seed 2 --port 0 --truth '" + truth + "' >'" + out +
                             "' & echo $! >'" + (folder / "pid") + "'; wait $!")
                                .c_str(),
                            "w");
  ASSERT_NE(simulator, nullptr);
  const auto clock = device_clock();
  const DeviceTime give_up = clock() + Duration::from_seconds(60.0);
  std::string line;
  while (line.find('\n') == std::string::npos && clock() < give_up) {
    std::this_thread::yield();
    if (std::filesystem::exists(out)) line = read_file(out);
  }
  const std::string kPort = " port ";
  ASSERT_NE(line.find(kPort), std::string::npos) << line;
  llrp::ReaderSettings settings;
  settings.host = "127.0.0.1";
  settings.port = static_cast<std::uint16_t>(std::stoi(line.substr(line.find(kPort) + kPort.size())));
  auto link = llrp::ReaderLink::create(settings, clock, 1);
  ASSERT_TRUE(link.ok());
  std::vector<TagRead> reads;
  while (reads.size() < 30 && clock() < give_up)
    for (const Event& event : link.value()->poll(Duration{50'000'000}))
      if (const auto* read = std::get_if<TagRead>(&event)) reads.push_back(*read);
  link.value()->stop();
  EXPECT_EQ(run_command("kill -TERM $(cat '" + (folder / "pid") + "')").exit_code, 0);
  EXPECT_EQ(::pclose(simulator), 0);
  ASSERT_GE(reads.size(), 30u);

  std::istringstream lines(read_file(truth));
  std::string row;
  std::getline(lines, row);
  EXPECT_EQ(row, "epc,port,phase_q16,frequency_hz,rssi_cdbm,doppler_hz_q4,seen_count,reader_us");
  for (const TagRead& r : reads) {
    ASSERT_TRUE(std::getline(lines, row));
    std::ostringstream expected;
    expected << r.epc.hex() << ',' << int{r.port} << ',' << r.phase.turn_q16 << ',' << r.frequency_hz << ','
             << r.rssi_cdbm << ',' << r.doppler_hz_q4 << ',' << r.seen_count << ',' << r.reader_time.us();
    EXPECT_EQ(row, expected.str());
  }
}

TEST(ReaderSimCommand, SaysInOneLineThatItsPortIsTaken) {
  const auto taken = net::listen_on("127.0.0.1", 0);
  ASSERT_TRUE(taken.ok());
  const std::string port = std::to_string(net::port_of(taken.value()));
  const auto ran = run_command(RFMVO_COMMAND " reader-sim --scene onetag --port " + port);
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_EQ(ran.err, "rfmvo reader-sim: 127.0.0.1:" + port + ": Address already in use\n");
}

TEST(ReaderSimCommand, RefusesAWrongCommandLine) {
  EXPECT_EQ(run_command(RFMVO_COMMAND " reader-sim --port 70000").exit_code, 2);
  EXPECT_EQ(run_command(RFMVO_COMMAND " reader-sim --accumulate 0").exit_code, 2);
  EXPECT_EQ(run_command(RFMVO_COMMAND " reader-sim --tls-cert only.pem").exit_code, 2);
}

}  // namespace
}  // namespace rfmvo
