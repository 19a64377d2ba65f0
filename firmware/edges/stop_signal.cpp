#include "edges/stop_signal.hpp"

#include <csignal>

namespace rfmvo {
namespace {

// Global, because a signal handler has nothing else to reach.
volatile std::sig_atomic_t stop_flag = 0;

volatile std::sig_atomic_t reload_flag = 0;

void on_signal(int) { stop_flag = 1; }
void on_reload(int) { reload_flag = 1; }

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

bool stop_requested() { return stop_flag != 0; }

void catch_reload_signal() {
  struct sigaction action {};
  action.sa_handler = on_reload;
  (void)::sigaction(SIGHUP, &action, nullptr);
}

bool take_reload_request() {
  if (reload_flag == 0) return false;
  reload_flag = 0;
  return true;
}

}  // namespace rfmvo
