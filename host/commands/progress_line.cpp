#include "commands/progress_line.hpp"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace rfmvo {

ProgressLine::ProgressLine(std::string what) : what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (terminal_) std::fprintf(stderr, "\r\033[K");
}

void ProgressLine::show(std::size_t done, std::size_t all) const {
  if (!terminal_) return;
  std::fprintf(stderr, "\r%zu of %zu %s", done, all, what_.c_str());
  std::fflush(stderr);
}

void ProgressLine::say(const std::string& text) const {
  if (!terminal_) return;
  std::fprintf(stderr, "\r\033[K%s", text.c_str());
  std::fflush(stderr);
}

}  // namespace rfmvo
