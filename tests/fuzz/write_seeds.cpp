// write_seeds DIR: well-formed input for each fuzz target, to start from; random bytes alone do not come far.
//   DIR/config, DIR/journal, DIR/llrp
#include <string>

#include "edges/journal.hpp"
#include "edges/lcm_codec.hpp"
#include "edges/llrp/reader_setup.hpp"
#include "edges/toml_files.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using testing::write_file;

std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

void write_llrp(const std::string& folder) {
  std::vector<llrp::Request> requests = llrp::goodbye_requests();
  requests.push_back(llrp::capabilities_request());
  std::string all;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const std::string frame = text_of(llrp::encode({static_cast<std::uint32_t>(i), requests[i].body}));
    write_file(folder + "/request" + std::to_string(i), frame);
    all += frame;
  }
  write_file(folder + "/requests", all);
}

Status write_journals(const std::string& folder) {
  testing::write_journal(folder + "/each_event", testing::one_of_each_event());
  testing::write_journal(folder + "/short_run", testing::short_run(5));
  auto results = LogWriter::create(folder + "/each_estimate", "RFMVO_");
  if (!results) return results.error();
  for (const Estimate& estimate : testing::one_of_each_estimate())
    if (const Status s = results.value()->publish(estimate); !s) return s;
  return results.value()->close();
}

Status write_seeds(const std::string& folder) {
  write_file(folder + "/config/all_keys.toml", to_toml(Config{}));
  write_file(folder + "/config/calibration.toml", to_toml(testing::sample_calibration()));
  write_llrp(folder + "/llrp");
  std::filesystem::create_directories(folder + "/journal");
  return write_journals(folder + "/journal");
}

}  // namespace
}  // namespace rfmvo

int main(int argc, char** argv) { return argc == 2 && rfmvo::write_seeds(argv[1]) ? 0 : 1; }
