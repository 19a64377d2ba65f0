// rfmvo status: how a box is, live.
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>

#include "commands/commands.hpp"
#include "config/config.hpp"
#include "edges/stop_signal.hpp"
#include "status/box_status.hpp"

namespace rfmvo {
namespace {

constexpr int kNotWell = 3;
constexpr Duration kListen{Duration::from_seconds(0.1)};
constexpr std::int64_t kNsPerS = 1'000'000'000;

struct Options {
  std::string url = LcmConfig{}.url, prefix = LcmConfig{}.prefix;
  bool once = false, json = false;
  double wait_s = 5.0;
};

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNsPerS + now.tv_nsec;
}

// Lines that are left for tags on a terminal of this height.
std::size_t tag_rows(bool terminal) {
  constexpr std::size_t kOtherLines = 13, kUnlimited = 100'000;
  winsize size{};
  if (!terminal || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return kUnlimited;
  return size.ws_row > kOtherLines ? size.ws_row - kOtherLines : 1;
}

class StatusCommand {
 public:
  StatusCommand(const Options& options, BusListener& bus)
      : options_(options), bus_(bus), status_(options.prefix), terminal_(::isatty(STDOUT_FILENO) == 1) {}

  // The exit code.
  Result<int> run() {
    const std::int64_t start_ns = monotonic_ns();
    std::int64_t shown_ns = start_ns;
    while (!stop_requested()) {
      auto message = bus_.next(kListen);
      if (!message) return message.error();
      const std::int64_t now_ns = monotonic_ns();
      if (message.value()) status_.on(*message.value(), now_ns);
      const bool waited = static_cast<double>(now_ns - start_ns) > options_.wait_s * static_cast<double>(kNsPerS);
      // A second report makes rates of the counters; all tags come with it.
      if (options_.once && (status_.rates() || waited)) return tell_once(now_ns);
      if (options_.once || now_ns - shown_ns < kNsPerS) continue;
      shown_ns = now_ns;
      if (!show(now_ns)) return 0;
    }
    return 0;
  }

 private:
  [[nodiscard]] status::View view(std::int64_t now_ns) const {
    const bool colours = terminal_ && std::getenv("NO_COLOR") == nullptr;
    return {now_ns, bus_.loss(), colours, tag_rows(terminal_ && !options_.once)};
  }
  Result<int> tell_once(std::int64_t now_ns) {
    if (options_.json) fmt::print("{}\n", status::to_json(status_, view(now_ns)));
    if (!status_.health())
      return Error{ErrorCode::kNotFound, fmt::format("no box was heard within {:g} s", options_.wait_s), options_.url};
    if (!options_.json) fmt::print("{}", status::to_screen(status_, view(now_ns)));
    return status_.problems(now_ns).empty() ? 0 : kNotWell;
  }
  // False: nobody reads it any more.
  bool show(std::int64_t now_ns) {
    const status::View now = view(now_ns);
    const std::string text = options_.json ? status::to_json(status_, now) + "\n"
                             : terminal_
                                 ? "\033[H\033[J" + status::to_screen(status_, now)  // from the top, the rest wiped
                                 : status::to_line(status_, now);
    return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  }

  const Options& options_;
  BusListener& bus_;
  status::BoxStatus status_;
  bool terminal_;
};

Result<int> run(const Options& options) {
  auto bus = open_bus_listener(options.url);
  if (!bus) return bus.error();
  catch_stop_signals();
  return StatusCommand(options, *bus.value()).run();
}

}  // namespace

void add_status_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("status", "How a box is: health, tags, rates; live, or once for scripts");
  command->add_flag("--once", options->once,
                    "Say it once and end: exit code 0 it is well, 3 it is not, 1 nothing heard");
  command->add_flag("--json", options->json, "As JSON on stdout: one object, or one a second and line");
  command->add_option("--wait-s", options->wait_s, "With --once: wait so long for a box to speak")
      ->check(CLI::Range(0.01, 3600.0))
      ->capture_default_str();
  command->add_option("--url", options->url, "LCM bus")->capture_default_str();
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    const auto code = run(*options);
    if (code) {
      exit_code = code.value();
      return;
    }
    fmt::print(stderr, "rfmvo status: {}\n", code.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
