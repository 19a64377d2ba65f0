// A real LCM bus for one test: a port of its own, and programs that run beside it.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <lcm/lcm-cpp.hpp>
#include <string>
#include <thread>

#include "bus/bus_listener.hpp"
#include "support/sample_events.hpp"

namespace rfmvo::testing {

// ctest runs tests side by side, each in a process of its own.
[[nodiscard]] inline std::string bus_url() {
  return "udpm://239.255.76.67:" + std::to_string(20'000 + ::getpid() % 20'000) + "?ttl=0";
}

// Some machines have no multicast at all.
[[nodiscard]] inline bool has_multicast() { return open_bus_listener(bus_url()).ok(); }

// A program in the background whose stdout and stderr go to files.
class Background {
 public:
  Background(const std::string& command, std::string out, std::string err)
      : out_(std::move(out)), err_(std::move(err)) {
    pid_ = ::fork();
    if (pid_ == 0) {
      ::execl("/bin/sh", "sh", "-c", ("exec " + command + " >'" + out_ + "' 2>'" + err_ + "'").c_str(), nullptr);
      ::_exit(127);
    }
  }
  ~Background() {
    if (pid_ > 0) (void)end(SIGKILL);
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  // Waits until `text` stands in one of the outputs. False: the program ended before.
  bool said(const std::string& text) {
    while (read_file(out_).find(text) == std::string::npos && read_file(err_).find(text) == std::string::npos) {
      if (::waitpid(pid_, &state_, WNOHANG) == pid_) {
        pid_ = 0;
        return false;
      }
      std::this_thread::yield();
    }
    return true;
  }
  // Sends the signal (0: none), waits; the exit code, -1 if it ended by a signal.
  int end(int signal) {
    if (pid_ > 0) {
      if (signal != 0) (void)::kill(pid_, signal);
      (void)::waitpid(pid_, &state_, 0);
      pid_ = 0;
    }
    return WIFEXITED(state_) ? WEXITSTATUS(state_) : -1;
  }
  [[nodiscard]] std::string out() const { return read_file(out_); }
  [[nodiscard]] std::string err() const { return read_file(err_); }

 private:
  std::string out_, err_;
  pid_t pid_ = 0;
  int state_ = 0;
};

}  // namespace rfmvo::testing
