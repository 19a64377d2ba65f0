// Nothing is overwritten without --force, whichever command writes it.
#include <gmock/gmock.h>

#include "host/host_command.hpp"

namespace rfmvo {
namespace {

using testing::expect_one_line;
using testing::in_quotes;
using testing::read_file;
using testing::TemporaryFolder;

struct Writer {
  const char* name;
  const char* arguments;  // %: the folder
};

class Overwrite : public ::testing::TestWithParam<Writer> {
 protected:
  [[nodiscard]] std::string arguments() const {
    std::string text;
    for (const char c : std::string(GetParam().arguments)) text += c == '%' ? folder_ / "" : std::string(1, c);
    return text;
  }
  TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Commands, Overwrite,
                         ::testing::Values(Writer{"simulate",
                                                  "simulate --scene onetag --no-frames --truth %truth --out %FILE"},
                                           Writer{"replay", "replay %run.lcmlog --out %FILE"},
                                           Writer{"replay_json", "replay %run.lcmlog --out %other --json %FILE"},
                                           Writer{"export_csv", "export %run.lcmlog --tags-csv %FILE"},
                                           Writer{"export_mcap", "export %run.lcmlog --mcap %FILE"},
                                           Writer{"report", "report %run.lcmlog --out %FILE"},
                                           Writer{"info", "info %run.lcmlog --json %FILE"},
                                           Writer{"bound", "bound --scene onetag --json %FILE"},
                                           Writer{"board", "calibrate board --out %FILE"}),
                         [](const auto& writer) { return std::string(writer.param.name); });

TEST_P(Overwrite, TakesForce) {
  testing::write_journal(folder_ / "run.lcmlog", testing::short_run(20));
  testing::write_file(folder_ / "FILE", "precious");
  expect_one_line(testing::rfmvo(arguments()), "FILE: is there already; --force overwrites it");
  EXPECT_EQ(read_file(folder_ / "FILE"), "precious");
  const auto forced = testing::rfmvo(arguments() + " --force");
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_NE(read_file(folder_ / "FILE"), "precious");
}

}  // namespace
}  // namespace rfmvo
