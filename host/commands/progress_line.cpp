#include "commands/progress_line.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace rfmvo {

ProgressLine::ProgressLine(std::string what) : what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (terminal_) std::fprintf(stderr, "\r\033[K");
}

bool ProgressLine::due() const {
  if (!terminal_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now - drawn_ < std::chrono::milliseconds(100)) return false;
  drawn_ = now;
  return true;
}

void ProgressLine::show(std::size_t done, std::size_t all) const {
  drawn_ = {};  // steps that someone counts are all drawn
  show_share(all > 0 ? static_cast<double>(done) / static_cast<double>(all) : 0.0,
             std::to_string(done) + " of " + std::to_string(all) + " " + what_);
}

void ProgressLine::show_share(double share, const std::string& text) const {
  constexpr double kWidth = 24;
  if (!due()) return;
  const auto filled = static_cast<std::size_t>(kWidth * std::clamp(share, 0.0, 1.0));
  std::string bar(filled, '#');
  bar.resize(static_cast<std::size_t>(kWidth), '.');
  std::fprintf(stderr, "\r\033[K[%s] %s", bar.c_str(), text.c_str());
  std::fflush(stderr);
}

void ProgressLine::say(const std::string& text) const {
  if (!due()) return;
  std::fprintf(stderr, "\r\033[K%s", text.c_str());
  std::fflush(stderr);
}

}  // namespace rfmvo
