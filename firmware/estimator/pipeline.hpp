// The whole job: events in, estimates out. No threads, clock, files or randomness in here.
#pragma once

#include <memory>
#include <span>

#include "estimator/estimate.hpp"
#include "estimator/event.hpp"
#include "estimator/worker.hpp"

namespace rfmvo {

class Pipeline {
 public:
  // `worker`: solves, see worker.hpp; it outlives the pipeline. Null: solved at once, with the same results.
  explicit Pipeline(Worker* worker = nullptr);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  // Estimates caused by this event; valid until the next call. Everything before the first Start is
  // ignored; a later Start begins anew.
  std::span<const Estimate> on(const Event& event);

  // The final solution over all that was seen, for the end of a log or a clean shutdown.
  std::span<const Estimate> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rfmvo
