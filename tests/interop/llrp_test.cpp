// Other people's LLRP on our wire: the clients of llrpkit and pyllrp against the simulated reader, our client
// against llrpkit's emulated one; their codecs and tshark judge every frame of either side.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "edges/llrp/reader_link.hpp"
#include "reader_sim/reader_server.hpp"
#include "support/llrp_dump.hpp"
#include "support/llrp_frames.hpp"
#include "support/reader_bench.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using testing::run_command;
using testing::TemporaryFolder;

const std::string kPython =
    "PYTHONPATH='" RFMVO_SOURCE_DIR "/tests/interop' PYTHONDONTWRITEBYTECODE=1 '" RFMVO_VENV "/bin/python3' ";
const std::string kScripts = "'" RFMVO_SOURCE_DIR "/tests/interop/";

// A simulated reader in a thread of its own, for as long as this lives.
class ServedReader {
 public:
  ServedReader() {
    reader_sim::ServerSettings settings;
    settings.port = 0;
    auto model = testing::sample_model(400, 0.002);
    model.loop = true;
    auto made = reader_sim::ReaderServer::create(settings, std::move(model), device_clock());
    EXPECT_TRUE(made.ok()) << made.error().text();
    server_ = std::move(made).value();
    thread_ = std::thread([this] {
      while (!stop_) server_->poll(Duration{5'000'000});
    });
  }
  ~ServedReader() { stop(); }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] std::string port() const { return std::to_string(server_->port()); }
  [[nodiscard]] const std::vector<TagRead>& truth() const { return server_->reader().reported(); }

 private:
  std::unique_ptr<reader_sim::ReaderServer> server_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

class LlrpInterop : public ::testing::Test {
 protected:
  void SetUp() override {
    if (run_command(kPython + "-c 'import llrpkit, pyllrp.pyllrp'").exit_code != 0)
      GTEST_SKIP() << "no llrpkit and pyllrp in " << RFMVO_VENV << " (cmake/install-packages.sh puts them there)";
  }
  // Every frame by llrpkit's codec, reports by pyllrp's too, and all by tshark.
  void judge(std::size_t least_reports) {
    const auto judged = run_command(kPython + kScripts + "llrp_judge.py' '" + frames_ + "' '" + pcap_ + "'");
    ASSERT_EQ(judged.exit_code, 0) << judged.err;
    EXPECT_EQ(judged.out.find("differs"), std::string::npos) << judged.out;
    const auto counts = nlohmann::json::parse(judged.out.substr(judged.out.rfind('{')));
    EXPECT_GE(counts.at("reports").get<std::size_t>(), least_reports);
    EXPECT_GE(counts.at("client").get<int>(), 5);
    if (run_command("command -v tshark").exit_code != 0) GTEST_SKIP() << "no tshark (package tshark)";
    const auto shark = run_command("tshark -n -r '" + pcap_ + "' -d tcp.port==5084,llrp -Y llrp -V");
    ASSERT_EQ(shark.exit_code, 0) << shark.err;
    EXPECT_NE(shark.out.find("Low Level Reader Protocol"), std::string::npos);
    std::istringstream lines(shark.out);
    std::string parameter;
    for (std::string line; std::getline(lines, line);) {
      if (line.find("TLV Parameter:") != std::string::npos) parameter = line;
      // It knows Impinj's phase, but not the Doppler frequency, subtype 68, and complains of every one.
      if (parameter.find("Unknown Type: 68") != std::string::npos) continue;
      EXPECT_EQ(line.find("Malformed"), std::string::npos) << parameter << line;
    }
  }
  // What the client says it has read, by the reader's own record.
  void expect_truth(const nlohmann::json& tags, const std::vector<TagRead>& truth) {
    ASSERT_GE(truth.size(), tags.size());
    const std::vector<std::uint32_t> channels_hz{921'625'000, 920'625'000, 921'125'000};
    for (std::size_t k = 0; k < tags.size(); ++k) {
      EXPECT_EQ(tags[k][0], truth[k].epc.hex()) << k;
      EXPECT_EQ(tags[k][1], truth[k].phase.turn_q16 >> 4) << k;
      EXPECT_EQ(tags[k][2], truth[k].port) << k;
      EXPECT_EQ(channels_hz.at(tags[k][3].get<std::size_t>() - 1), truth[k].frequency_hz) << k;
      EXPECT_EQ(tags[k][4], truth[k].rssi_cdbm) << k;
      EXPECT_EQ(tags[k][5], truth[k].reader_time.us()) << k;
    }
  }
  void client_reads_our_reader(const std::string& script) {
    ServedReader reader;
    const auto ran = run_command(kPython + kScripts + script + "' " + reader.port() + " 300 '" + frames_ + "'");
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    reader.stop();
    const auto tags = nlohmann::json::parse(ran.out);
    EXPECT_GE(tags.size(), 300u);
    expect_truth(tags, reader.truth());
    judge(300);
  }
  TemporaryFolder folder_;
  std::string frames_ = folder_ / "frames.json";
  std::string pcap_ = folder_ / "frames.pcap";
};

// What the toolkit's XML says of its own frames.
TEST_F(LlrpInterop, OurDecoderReadsWhatTheToolkitWrote) {
  if (!std::filesystem::exists(testing::llrp_data(""))) GTEST_SKIP() << "no LLRP frames in " << testing::llrp_data("");
  for (const auto& [bin, xml, least] :
       {std::tuple{"ltk_vectors/dx101_a.bin", "ltk_vectors/dx101_a.xml", 934},
        {"ltk_vectors/dx101_b.bin", "ltk_vectors/dx101_b.xml", 24},
        {"ltk_vectors/dx101_e.bin", "ltk_vectors/dx101_e.xml", 700},
        {"golden/impinj_phase_reports.bin", "golden/impinj_phase_reports.core.xml", 4}}) {
    auto dumps = nlohmann::json::array();
    for (const auto& frame : testing::frames_of(testing::llrp_data(bin))) {
      const auto decoded = llrp::decode(frame);
      ASSERT_TRUE(decoded.ok()) << bin << ": " << decoded.error().text();
      dumps.push_back(testing::dump(decoded.value().message));
    }
    testing::write_file(frames_, dumps.dump());
    const auto compared =
        run_command(kPython + kScripts + "llrp_xml.py' '" + testing::llrp_data(xml) + "' '" + frames_ + "'");
    ASSERT_EQ(compared.exit_code, 0) << compared.err;
    EXPECT_EQ(compared.out.find("differs"), std::string::npos) << bin << ": " << compared.out.substr(0, 2000);
    EXPECT_EQ(compared.out.substr(compared.out.rfind("compared")), "compared " + std::to_string(least) + "\n");
  }
}

TEST_F(LlrpInterop, LlrpkitReadsOurReader) { client_reads_our_reader("llrp_llrpkit_client.py"); }

TEST_F(LlrpInterop, PyllrpReadsOurReader) { client_reads_our_reader("llrp_pyllrp_client.py"); }

TEST_F(LlrpInterop, OurClientReadsLlrpkitsReader) {
  const std::string out = folder_ / "port";
  // Its standard input is a pipe that ends when we say so.
  FILE* emulator =
      ::popen((kPython + kScripts + "llrp_llrpkit_emulator.py' '" + frames_ + "' >'" + out + "'").c_str(), "w");
  ASSERT_NE(emulator, nullptr);
  const auto clock = device_clock();
  const DeviceTime give_up = clock() + Duration::from_seconds(60.0);
  std::string port;
  while (port.find('\n') == std::string::npos && clock() < give_up) {
    std::this_thread::yield();
    if (std::filesystem::exists(out)) port = testing::read_file(out);
  }
  ASSERT_FALSE(port.empty());
  llrp::ReaderSettings settings;
  settings.host = "127.0.0.1";
  settings.port = static_cast<std::uint16_t>(std::stoi(port));
  auto link = llrp::ReaderLink::create(settings, clock, 1);
  ASSERT_TRUE(link.ok());
  std::vector<TagRead> reads;
  std::vector<std::string> faults;
  while (reads.size() < 200 && clock() < give_up)
    for (const Event& event : link.value()->poll(Duration{50'000'000})) {
      if (const auto* read = std::get_if<TagRead>(&event)) reads.push_back(*read);
      if (const auto* fault = std::get_if<Fault>(&event)) faults.push_back(fault->text);
    }
  link.value()->stop();
  EXPECT_EQ(::pclose(emulator), 0);
  EXPECT_GE(reads.size(), 200u) << ::testing::PrintToString(faults);
  for (const TagRead& read : reads) {
    EXPECT_GE(read.frequency_hz, 840'000'000u);
    EXPECT_EQ(read.seen_count, 1);
    // Same machine, same clock: apart by the time that a report takes.
    EXPECT_NEAR((read.time - DeviceTime{read.reader_time.ns}).seconds(), 0.0, 1.0);
  }
  judge(50);
}

}  // namespace
}  // namespace rfmvo
