// A bar and "3 of 20 seeds", rewritten in place on stderr; silent where stderr is no terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace rfmvo {

class ProgressLine {
 public:
  explicit ProgressLine(std::string what);
  ~ProgressLine();  // wipes the line
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void show(std::size_t done, std::size_t all) const;
  // The bar of a share, 0 to 1, and a text. Cheap to call often: it is drawn ten times a second.
  void show_share(double share, const std::string& text) const;
  void say(const std::string& text) const;  // without a bar; as often

 private:
  [[nodiscard]] bool due() const;

  std::string what_;
  bool terminal_;
  mutable std::chrono::steady_clock::time_point drawn_{};
};

}  // namespace rfmvo
