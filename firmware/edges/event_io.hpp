// The doors of the program: where events come from, where events and estimates go. Live, replay and
// simulation differ only in what stands behind these.
#pragma once

#include <optional>

#include "base/result.hpp"
#include "estimator/estimate.hpp"
#include "estimator/event.hpp"
#include "estimator/pipeline.hpp"

namespace rfmvo {

class EventSource {
 public:
  virtual ~EventSource() = default;
  // The next event; nothing at the end.
  [[nodiscard]] virtual Result<std::optional<Event>> next() = 0;
};

class EventSink {
 public:
  virtual ~EventSink() = default;
  [[nodiscard]] virtual Status write(const Event& event) = 0;
};

class EstimateSink {
 public:
  virtual ~EstimateSink() = default;
  [[nodiscard]] virtual Status publish(const Estimate& estimate) = 0;
};

// The one loop: next event, journal, estimate, publish; at the end the final solution. journal may be null.
[[nodiscard]] Status run(EventSource& source, EventSink* journal, Pipeline& pipeline, EstimateSink& out);

}  // namespace rfmvo
