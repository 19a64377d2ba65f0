// Who does the work that the next frame cannot wait for. The estimator itself knows no threads: the daemon brings a
// worker that has one, replay and tests let the work be done at once. The results are the same bits.
#pragma once

#include <functional>

namespace rfmvo {

class Worker {
 public:
  virtual ~Worker() = default;
  // One work at a time; it may run until wait() returns. It does not throw.
  virtual void start(std::function<void()> work) = 0;
  virtual void wait() = 0;
};

class InlineWorker final : public Worker {
 public:
  void start(std::function<void()> work) override { work(); }
  void wait() override {}
};

}  // namespace rfmvo
