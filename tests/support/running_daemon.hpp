// rfmvod as a child process, with what it writes to stderr in a file.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "support/sample_events.hpp"

namespace rfmvo::testing {

class RunningDaemon {
 public:
  // environment: NAME=VALUE, beside this process's own.
  RunningDaemon(const std::string& program, std::vector<std::string> arguments, std::string log,
                const std::vector<std::pair<std::string, std::string>>& environment = {})
      : log_(std::move(log)) {
    arguments.insert(arguments.begin(), program);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ != 0) return;
    const int fd = ::open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    (void)::dup2(fd, STDERR_FILENO);
    for (const auto& [name, value] : environment) (void)::setenv(name.c_str(), value.c_str(), 1);
    ::execv(program.c_str(), argv.data());
    ::_exit(127);
  }
  ~RunningDaemon() {
    if (pid_ <= 0) return;
    signal(SIGKILL);
    (void)wait();
  }
  RunningDaemon(const RunningDaemon&) = delete;
  RunningDaemon& operator=(const RunningDaemon&) = delete;

  void signal(int number) const { (void)::kill(pid_, number); }
  // Its exit code; 1000 + the signal that ended it.
  [[nodiscard]] int wait() {
    int status = 0;
    (void)::waitpid(std::exchange(pid_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  [[nodiscard]] bool is_running() {
    if (pid_ <= 0) return false;
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0;
  }
  [[nodiscard]] std::string log() const { return read_file(log_); }
  // True once it has written that; false: it has ended without.
  [[nodiscard]] bool says(const std::string& text) {
    while (log().find(text) == std::string::npos) {
      if (!is_running()) return log().find(text) != std::string::npos;
      (void)::usleep(5000);
    }
    return true;
  }

 private:
  std::string log_;
  pid_t pid_ = -1;
};

}  // namespace rfmvo::testing
