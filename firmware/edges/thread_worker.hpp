// A worker with a thread of its own (estimator/worker.hpp).
#pragma once

#include <future>

#include "estimator/worker.hpp"

namespace rfmvo {

class ThreadWorker final : public Worker {
 public:
  ~ThreadWorker() override { wait(); }
  void start(std::function<void()> work) override {
    wait();
    running_ = std::async(std::launch::async, std::move(work));
  }
  void wait() override {
    if (running_.valid()) running_.get();
  }

 private:
  std::future<void> running_;
};

}  // namespace rfmvo
