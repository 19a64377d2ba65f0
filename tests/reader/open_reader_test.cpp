// The reader that a configuration names, and what a build may be without.
#include "edges/open_reader.hpp"

#include <gtest/gtest.h>

#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using testing::run_command;
using testing::TemporaryFolder;

std::string error_of(const ReaderConfig& reader) {
  Config config;
  config.reader = reader;
  const auto opened = open_reader(config, std::nullopt, device_clock());
  return opened.ok() ? "" : opened.error().text();
}

TEST(OpenReader, TakesListsOfAntennaPorts) {
  for (const char* text : {"", "1", "1,2", "1, 2,32", "255"}) {
    ReaderConfig reader;
    reader.address = "192.0.2.1";
    reader.antennas = text;
    EXPECT_EQ(error_of(reader), "") << text;
  }
  for (const char* text : {"0", "256", "1,", ",1", "one", "1 2", "-1", "1;2"}) {
    ReaderConfig reader;
    reader.antennas = text;
    EXPECT_EQ(error_of(reader),
              "reader.antennas: expects antenna ports from 1, such as 1,2, not \"" + std::string(text) + "\"");
  }
}

TEST(OpenReader, NamesTheTlsFileThatCannotBeRead) {
  ReaderConfig reader;
  reader.tls = true;
  reader.tls_ca = "/nowhere/ca.pem";
  EXPECT_EQ(error_of(reader).substr(0, 16), "/nowhere/ca.pem:");
}

#ifndef RFMVO_WITH_LTKCPP
TEST(OpenReader, SaysThatItWasBuiltWithoutTheToolkit) {
  ReaderConfig reader;
  reader.backend = "ltkcpp";
  EXPECT_EQ(error_of(reader), "reader.backend: this program was built without the LLRP Toolkit (RFMVO_WITH_LTKCPP)");
}
#endif

// Configuring for the toolkit where it is not: one error, and it names the place.
TEST(LtkcppOption, WithAWrongPathIsOneClearErrorOfCmake) {
  const TemporaryFolder folder;
  const auto configured = run_command("cmake -S '" RFMVO_SOURCE_DIR "' -B '" + (folder / "build") +
                                      "' -DRFMVO_WITH_LTKCPP=ON -DLTKCPP_ROOT=/nowhere/ltk");
  EXPECT_NE(configured.exit_code, 0);
  std::size_t errors = 0;
  for (std::size_t at = configured.err.find("CMake Error"); at != std::string::npos;
       at = configured.err.find("CMake Error", at + 1))
    ++errors;
  EXPECT_EQ(errors, 1u) << configured.err;
  EXPECT_NE(configured.err.find("LTKCPP_ROOT=\"/nowhere/ltk\""), std::string::npos) << configured.err;
}

}  // namespace
}  // namespace rfmvo
