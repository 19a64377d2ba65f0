// librfmvo (base to estimator) computes and does nothing else: no threads, clock, files, sockets,
// environment, randomness; and its layers include only what is below them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

namespace fs = std::filesystem;
using testing::run_command;

const std::map<std::string, std::set<std::string>>& allowed_layers() {
  static const std::set<std::string> kLow{"base", "config", "geometry", "kernels"};
  static const std::set<std::string> kMiddle{"base", "config", "geometry", "kernels", "vision", "rf", "estimator"};
  static const std::map<std::string, std::set<std::string>> kAllowed{
      {"base", {"base"}},
      {"config", {"base", "config", "geometry"}},
      {"geometry", {"base", "geometry"}},
      {"kernels", {"base", "kernels"}},
      {"rf", {"base", "config", "geometry", "kernels", "rf"}},
      {"vision", kMiddle},  // Frame and CameraPose are events
      {"estimator", kMiddle},
  };
  return kAllowed;
}

std::vector<std::string> includes_of(const fs::path& file) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*([<"][^>"]+)[>"])");
  std::vector<std::string> includes;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::smatch match;
    if (std::regex_search(line, match, kInclude)) includes.push_back(match[1]);
  }
  return includes;
}

template <class Check>
void for_each_include(const Check& check) {
  for (const auto& [layer, allowed] : allowed_layers()) {
    const fs::path folder = fs::path(RFMVO_SOURCE_DIR) / "firmware" / layer;
    if (!fs::exists(folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".hpp") continue;
      for (const std::string& include : includes_of(entry.path())) check(entry.path(), include, allowed);
    }
  }
}

TEST(CoreLibrary, IncludesNothingThatReachesOutside) {
  static const std::set<std::string> kForbidden{
      "thread", "mutex", "shared_mutex", "condition_variable", "future", "atomic", "stop_token", "semaphore", "latch",
      "barrier", "chrono", "ctime", "time.h", "sys/time.h", "fstream", "filesystem", "iostream", "random", "unistd.h",
      "fcntl.h", "stdio.h", "csignal", "signal.h", "pthread.h", "execution"};
  for_each_include([](const fs::path& file, const std::string& include, const auto&) {
    if (include[0] != '<') return;
    const std::string name = include.substr(1);
    EXPECT_FALSE(kForbidden.contains(name) || name.starts_with("sys/") || name.starts_with("lcm/") ||
                 name.starts_with("toml") || name.starts_with("spdlog") || name.starts_with("opencv2/highgui") ||
                 name.starts_with("opencv2/imgcodecs") || name.starts_with("opencv2/videoio"))
        << file << " includes <" << name << ">";
  });
}

TEST(CoreLibrary, LayersIncludeOnlyWhatIsBelowThem) {
  for_each_include([](const fs::path& file, const std::string& include, const std::set<std::string>& allowed) {
    if (include[0] != '"') return;
    const std::string layer = include.substr(1, include.find('/') - 1);
    EXPECT_TRUE(allowed.contains(layer)) << file << " includes " << include.substr(1);
  });
}

TEST(CoreLibrary, OnlyVisionKnowsOpenCv) {
  for_each_include([](const fs::path& file, const std::string& include, const auto&) {
    if (include.starts_with("<opencv2/")) {
      EXPECT_EQ(file.parent_path().filename(), "vision") << file;
    }
  });
}

// What the objects of the library call, as the linker sees it.
TEST(CoreLibrary, CallsNoThreadClockFileSocketEnvironmentOrRandomness) {
  const auto symbols = run_command("nm --undefined-only --format=posix " RFMVO_CORE_LIBRARY " | cut -d' ' -f1 | sort -u");
  ASSERT_EQ(symbols.exit_code, 0) << symbols.err;
  ASSERT_NE(symbols.out.find("abort"), std::string::npos) << "nm has read the library";
  // fprintf and stderr are RFMVO_ASSERT's; __gthread symbols are weak references of libstdc++'s headers.
  static const std::regex kForbidden(
      "^(pthread_create|thrd_create|_ZNSt6thread.*|fopen|fopen64|open|open64|openat|creat|fread|fwrite|read|write|"
      "socket|connect|bind|sendto|recv|getenv|secure_getenv|setenv|putenv|time|clock|gettimeofday|clock_gettime|"
      "_ZNSt6chrono3_V2.*|nanosleep|usleep|sleep|rand|srand|random|srandom|drand48|getrandom|getentropy|"
      "_ZNSt13random_device.*|_ZNSt14basic_ifstream.*|_ZNSt14basic_ofstream.*|_ZNSt13basic_fstream.*|"
      "_ZNSt10filesystem.*|system|popen|fork|dlopen|_ZN2cv3RNG.*|_ZN2cv5theRNG.*|_ZN2cv13setNumThreads.*|"
      "_ZN2cv12getTickCount.*|_ZSt4cout|_ZSt4cerr)$");
  std::istringstream lines(symbols.out);
  for (std::string symbol; std::getline(lines, symbol);)
    EXPECT_FALSE(std::regex_match(symbol, kForbidden)) << "librfmvo calls " << symbol;
}

}  // namespace
}  // namespace rfmvo
