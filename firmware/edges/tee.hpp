// Publishes each estimate to several places, in the order in which they were added.
#pragma once

#include <vector>

#include "edges/event_io.hpp"

namespace rfmvo {

class Tee : public EstimateSink {
 public:
  void add(EstimateSink& sink) { sinks_.push_back(&sink); }
  [[nodiscard]] Status publish(const Estimate& estimate) override {
    for (EstimateSink* sink : sinks_)
      if (Status s = sink->publish(estimate); !s) return s;
    return Done{};
  }

 private:
  std::vector<EstimateSink*> sinks_;
};

}  // namespace rfmvo
