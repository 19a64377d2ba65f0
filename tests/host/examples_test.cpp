// The subscribers of examples/, on a real bus: each prints every output once it is said, and both print the same.
#include <gmock/gmock.h>

#include <atomic>
#include <set>
#include <sstream>

#include "edges/lcm_codec.hpp"
#include "host/host_command.hpp"
#include "host/real_bus.hpp"

namespace rfmvo {
namespace {

using testing::Background;
using testing::in_quotes;
using testing::TemporaryFolder;

std::set<std::string> lines_of(const std::string& text) {
  std::set<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (line != "listening") lines.insert(line);
  return lines;
}

class Subscribers : public ::testing::Test {
 protected:
  // What a subscriber prints when one of each output is said, and said again until it has heard all.
  std::set<std::string> heard_by(const std::string& command) {
    Background subscriber(command + " " + in_quotes(url_), folder_ / "out", folder_ / "err");
    EXPECT_TRUE(subscriber.said("listening")) << subscriber.err();
    lcm::LCM bus(url_);
    for (int k = 0; k < 2000 && lines_of(subscriber.out()).size() < kOutputs; ++k) {
      for (const Estimate& estimate : testing::one_of_each_estimate())
        for (const LcmMessage& m : encode(estimate, "RFMVO_"))
          bus.publish(m.channel, m.data.data(), static_cast<unsigned>(m.data.size()));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    (void)subscriber.end(SIGTERM);
    std::set<std::string> lines;
    const std::string out = subscriber.out();
    for (const std::string& line : lines_of(out.substr(0, out.rfind('\n')))) lines.insert(line);
    return lines;
  }
  static constexpr std::size_t kOutputs = 8;
  TemporaryFolder folder_;
  std::string url_ = testing::bus_url();
};

TEST_F(Subscribers, CppAndPythonPrintEveryOutputAndTheSame) {
  if (!testing::has_multicast()) GTEST_SKIP() << "this machine has no multicast";
  const auto cpp = heard_by(RFMVO_EXAMPLE_SUBSCRIBER);
  EXPECT_EQ(cpp.size(), kOutputs);
  for (const char* name : {"TAG", "SCALE", "METRIC_POSE", "POSE", "TRAJECTORY", "MAP_REVISION", "VO_POSE", "HEALTH"})
    EXPECT_EQ(
        std::count_if(cpp.begin(), cpp.end(), [&](const auto& l) { return l.starts_with(std::string(name) + " "); }), 1)
        << name;
  EXPECT_EQ(cpp.count("TAG E28011602000600D3CA80AE1 not certain (status 3, 2 hypotheses)"), 1u);

  const std::string python = std::string(RFMVO_VENV) + "/bin/python3";
  if (testing::run_command("'" + python + "' -c 'import lcm'").exit_code != 0)
    GTEST_SKIP() << "no Python lcm in " << RFMVO_VENV << " (cmake/install-packages.sh puts it there)";
  const auto generated = testing::run_command("lcm-gen --python --ppath " + in_quotes(folder_ / "types") +
                                              " " RFMVO_SOURCE_DIR "/lcm_types/rfmvo/*.lcm");
  ASSERT_EQ(generated.exit_code, 0) << generated.err;
  EXPECT_EQ(heard_by("env PYTHONPATH=" + in_quotes(folder_ / "types") + " '" + python +
                     "' " RFMVO_SOURCE_DIR "/examples/subscriber.py"),
            cpp);
}

}  // namespace
}  // namespace rfmvo
