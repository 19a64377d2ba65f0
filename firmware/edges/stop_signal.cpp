#include "edges/stop_signal.hpp"

#include <atomic>
#include <csignal>

namespace rfmvo {
namespace {

// Global, because a signal handler has nothing else to reach.
std::atomic<bool> stop_flag{false};

std::atomic<bool> reload_flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "or a signal handler may not touch it");

void on_signal(int) { stop_flag = true; }
void on_reload(int) { reload_flag = true; }

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // and no SA_RESTART
  (void)::sigaction(SIGTERM, &action, nullptr);
  (void)::sigaction(SIGINT, &action, nullptr);
  // A peer that is gone is an error of the write, not the end of the program.
  (void)::signal(SIGPIPE, SIG_IGN);
}

bool stop_requested() { return stop_flag; }

void catch_reload_signal() {
  struct sigaction action {};
  action.sa_handler = on_reload;
  (void)::sigaction(SIGHUP, &action, nullptr);
}

bool take_reload_request() { return reload_flag.exchange(false); }

void request_reload() { reload_flag = true; }

}  // namespace rfmvo
