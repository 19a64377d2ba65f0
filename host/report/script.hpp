// The drawing part of a gnuplot script: data blocks, then one `plot` command over them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace rfmvo::report {

// One data block of the script and how it is drawn; blocks without data are not drawn.
struct Layer {
  std::string data;
  std::string style;
};

class Script {
 public:
  // True if there was something to draw.
  bool add(Layer layer) {
    const bool drawn = !layer.data.empty();
    if (drawn) layers_.push_back(std::move(layer));
    return drawn;
  }
  [[nodiscard]] std::string text() const;

 private:
  std::vector<Layer> layers_;
};

}  // namespace rfmvo::report
