// Man page, completion and --help are of one source: what one has, the others have.
#include <gmock/gmock.h>

#include <regex>
#include <set>
#include <sstream>

#include "host/host_command.hpp"

namespace rfmvo {
namespace {

using ::testing::HasSubstr;
using testing::in_quotes;
using testing::rfmvo;
using testing::run_command;
using testing::TemporaryFolder;

std::set<std::string> found(const std::string& text, const std::string& pattern) {
  std::set<std::string> all;
  const std::regex expression(pattern);
  for (std::sregex_iterator i(text.begin(), text.end(), expression), end; i != end; ++i) all.insert((*i)[1]);
  return all;
}

std::set<std::string> subcommands(const std::string& of) {
  const std::string help = rfmvo(of + " --help").out;
  const std::size_t at = help.find("Subcommands:");
  return at == std::string::npos ? std::set<std::string>() : found(help.substr(at), "\n  ([a-z-]+) ");
}

// With those of groups in full: "calibrate camera".
std::set<std::vector<std::string>> commands() {
  std::set<std::vector<std::string>> all;
  for (const std::string& command : subcommands("")) {
    const auto inner = subcommands(command);
    for (const std::string& sub : inner) all.insert({command, sub});
    if (inner.empty()) all.insert({command});
  }
  return all;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::set<std::string> options_of(const std::string& command) {
  const std::string help = rfmvo(command + " --help").out;
  return found(help.substr(0, help.find("Exit codes:")), "[ ,](--[a-z0-9-]+)");
}

// What bash offers for this line.
class Completion : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_command(RFMVO_COMMAND " completion >" + in_quotes(folder_ / "rfmvo.bash")).exit_code, 0);
  }
  std::set<std::string> completed(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) line += " " + in_quotes(word);
    const auto result =
        run_command("cd " + in_quotes(folder_ / "") +
                    " && bash -c 'source ./rfmvo.bash; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _rfmvo; "
                    "printf \"%s\\n\" \"${COMPREPLY[@]}\"' bash" +
                    line);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return found("\n" + result.out, "\n([^\n]+)");
  }
  TemporaryFolder folder_;
};

TEST(Manual, HasEveryOptionOfEveryCommand) {
  const std::string page = std::regex_replace(rfmvo("man").out, std::regex(R"(\\-)"), "-");
  const auto all = commands();
  ASSERT_GT(all.size(), 10u);
  for (const auto& words : all) {
    const std::string command = joined(words);
    EXPECT_THAT(page, HasSubstr(".SS " + command + "\n"));
    for (const std::string& option : options_of(command)) EXPECT_THAT(page, HasSubstr(option)) << command;
  }
  EXPECT_THAT(page, HasSubstr(".SH EXIT STATUS"));
}

TEST(Manual, IsRoffThatRoffDoesNotComplainAbout) {
  if (run_command("command -v groff").exit_code != 0) GTEST_SKIP() << "no groff";
  const auto shown = run_command(RFMVO_COMMAND " man | groff -man -Tascii -ww -z 2>&1");
  EXPECT_EQ(shown.out, "");
}

TEST_F(Completion, OffersTheCommands) {
  auto offered = completed({"rfmvo", ""});
  EXPECT_EQ(offered.erase("--help") + offered.erase("--version"), 2u);
  EXPECT_EQ(offered, subcommands(""));
  EXPECT_EQ(completed({"rfmvo", "sim"}), (std::set<std::string>{"simulate"}));
  EXPECT_EQ(completed({"rfmvo", "calibrate", ""}), subcommands("calibrate"));
}

TEST_F(Completion, OffersTheOptionsOfTheCommand) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"log"}, {"replay"}, {"calibrate", "camera"}}) {
    std::vector<std::string> line = {"rfmvo"};
    line.insert(line.end(), words.begin(), words.end());
    line.emplace_back("--");
    EXPECT_EQ(completed(line), options_of(joined(words)));
  }
}

TEST_F(Completion, OffersTheChoicesOfAnOptionAndElseFiles) {
  testing::write_file(folder_ / "run.lcmlog", "");
  EXPECT_EQ(completed({"rfmvo", "replay", "--estimator", ""}), (std::set<std::string>{"joint", "paper"}));
  EXPECT_EQ(completed({"rfmvo", "info", "run"}), (std::set<std::string>{"run.lcmlog"}));
}

TEST(Help, EndsWithTheExitCodes) { EXPECT_THAT(rfmvo("--help").out, HasSubstr("Exit codes: 0 done; 1 it failed")); }

TEST(Colours, AreNotWhereThereIsNoTerminal) {
  for (const char* arguments : {"--help", "info --help", "man"})
    EXPECT_EQ(rfmvo(arguments).out.find('\033'), std::string::npos);
}

}  // namespace
}  // namespace rfmvo
