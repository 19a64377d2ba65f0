// "3 of 20 seeds", rewritten in place on stderr; silent where stderr is no terminal.
#pragma once

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
  void say(const std::string& text) const;  // in place of it

 private:
  std::string what_;
  bool terminal_;
};

}  // namespace rfmvo
