// rfmvo view: a box, or a log, in the browser.
#include <fmt/format.h>

#include <atomic>
#include <cstdio>
#include <ctime>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "commands/commands.hpp"
#include "config/config.hpp"
#include "edges/stop_signal.hpp"
#include "play/player.hpp"
#include "view/page.hpp"
#include "view/view_model.hpp"
#include "view/web_server.hpp"

namespace rfmvo {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;
constexpr Duration kListen{Duration::from_seconds(0.05)};

struct Options {
  std::string log, frames;
  std::string url = LcmConfig{}.url, prefix = LcmConfig{}.prefix;
  view::WebSettings web;
  play::PlaySettings play;
};

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNsPerS + now.tv_nsec;
}

// What a thread fills and the server's thread shows.
class Shared {
 public:
  explicit Shared(const std::string& prefix) : model_(prefix) {}

  void on(const BusMessage& message, const BusLoss& loss) {
    const std::lock_guard lock(mutex_);
    model_.on(message, monotonic_ns());
    loss_ = loss;
  }
  void fail(Error error) {
    const std::lock_guard lock(mutex_);
    error_ = std::move(error);
  }
  [[nodiscard]] std::optional<Error> error() {
    const std::lock_guard lock(mutex_);
    return error_;
  }
  // What has changed goes to the pages: pictures and what is drawn in them at every tick, the rest once a second.
  void publish(view::WebServer& server) {
    const std::lock_guard lock(mutex_);
    if (server.pages() != pages_) seen_ = {}, slow_ns_ = 0;  // a page that is new has nothing yet
    pages_ = server.pages();
    if (model_.picture_version() > seen_.picture) server.publish(view::Slot::kPicture, model_.picture());
    if (model_.overlay_version() > seen_.overlay) server.publish(view::Slot::kOverlay, model_.overlay());
    seen_.picture = model_.picture_version();
    seen_.overlay = model_.overlay_version();
    const std::int64_t now_ns = monotonic_ns();
    if (now_ns - slow_ns_ < kNsPerS) return;
    slow_ns_ = now_ns;
    if (model_.map_version() > seen_.map) server.publish(view::Slot::kMap, model_.map());
    seen_.map = model_.map_version();
    server.publish(view::Slot::kStatus, model_.status({now_ns, loss_, false, 0}));
  }

 private:
  struct Versions {
    std::uint64_t picture = 0, overlay = 0, map = 0;
  };
  std::mutex mutex_;
  view::ViewModel model_;
  BusLoss loss_{false, 0, 0};
  std::optional<Error> error_;
  Versions seen_;
  std::int64_t slow_ns_ = 0;
  std::size_t pages_ = 0;
};

// Plays a log into the pages.
class PageDoor : public play::PlayDoor {
 public:
  PageDoor(Shared& shared, const std::atomic<bool>& stop) : shared_(shared), stop_(stop) {}
  std::int64_t now_ns() override { return monotonic_ns(); }
  play::Key wait_until(std::int64_t ns) override {
    while (!stop_ && monotonic_ns() < ns)
      std::this_thread::sleep_for(std::chrono::nanoseconds(std::min<std::int64_t>(ns - monotonic_ns(), 50'000'000)));
    return stop_ ? play::Key::kQuit : play::Key::kNone;
  }
  Status send(const LogRecord& record, Duration) override {
    shared_.on({record.channel, record.data}, {false, 0, 0});
    return Done{};
  }

 private:
  Shared& shared_;
  const std::atomic<bool>& stop_;
};

void play_logs(const Options& options, Shared& shared, const std::atomic<bool>& stop) {
  PageDoor door(shared, stop);
  std::vector<std::string> logs = {options.log};
  if (!options.frames.empty()) logs.insert(logs.begin(), options.frames);
  const auto played = play::play(logs, options.play, door);
  if (!played) shared.fail(played.error());
}

void listen(BusListener& bus, Shared& shared, const std::atomic<bool>& stop) {
  while (!stop) {
    auto message = bus.next(kListen);
    if (!message) return shared.fail(message.error());
    if (message.value()) shared.on(*message.value(), bus.loss());
  }
}

// Files that are not there are said before the page is offered.
Status check_logs(const Options& options) {
  for (const std::string& log : {options.log, options.frames}) {
    if (log.empty()) continue;
    if (const auto opened = LogFileReader::open(log); !opened) return opened.error();
  }
  return Done{};
}

Status run(Options options) {
  if (const Status s = check_logs(options); !s) return s;
  std::unique_ptr<BusListener> bus;
  if (options.log.empty()) {
    auto opened = open_bus_listener(options.url);
    if (!opened) return opened.error();
    bus = std::move(opened).value();
  }
  if (options.web.token.empty() && !view::is_loopback(options.web.address)) options.web.token = view::random_token();
  auto server = view::WebServer::create(options.web, view::kPage);
  if (!server) return server.error();
  catch_stop_signals();
  fmt::print("http://{}:{}/{}\n", options.web.address == "0.0.0.0" ? "THIS-MACHINE" : options.web.address,
             server.value()->port(), options.web.token.empty() ? "" : "?token=" + options.web.token);
  std::fflush(stdout);

  Shared shared(options.prefix);
  std::atomic<bool> stop{false};
  std::thread source([&] { bus ? listen(*bus, shared, stop) : play_logs(options, shared, stop); });
  std::optional<Error> error;
  server.value()->run([&] {
    shared.publish(*server.value());
    error = shared.error();
    return !stop_requested() && !error;
  });
  stop = true;
  source.join();
  return error ? Status(*error) : Status(Done{});
}

}  // namespace

void add_view_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("view", "A box, live, or a log in the browser: picture with tags, map, health");
  auto* log = command->add_option("log", options->log, "Result or journal to play (.lcmlog); default: the bus");
  command->add_option("--frames", options->frames, "Journal with the pictures, if the log has none")->needs(log);
  command->add_option("--speed", options->play.speed, "Of a log")->check(CLI::Range(1e-3, 1e4))->needs(log);
  command->add_flag("--loop", options->play.loop, "A log: again and again")->needs(log);
  command
      ->add_option("--listen", options->web.address,
                   "Address to listen on; other than of this machine alone, a token is needed (and made)")
      ->capture_default_str();
  command->add_option("--port", options->web.port, "TCP port; 0: any free one")->capture_default_str();
  command->add_option("--token", options->web.token, "Who wants the page must know this: /?token=...");
  command->add_option("--url", options->url, "LCM bus")->capture_default_str();
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->callback([options, &exit_code] {
    const Status status = run(*options);
    if (status) return;
    fmt::print(stderr, "rfmvo view: {}\n", status.error().text());
    exit_code = 1;
  });
}

}  // namespace rfmvo
