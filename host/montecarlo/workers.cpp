#include "montecarlo/workers.hpp"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace rfmvo::montecarlo {

Status in_parallel(std::size_t count, std::size_t jobs, const std::function<Status(std::size_t)>& work,
                   const Progress& progress) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::mutex telling;
  std::size_t done = 0;
  std::map<std::size_t, Error> errors;
  const auto worker = [&] {
    for (std::size_t i = next++; i < count && !failed; i = next++) {
      const Status status = work(i);
      const std::lock_guard lock(telling);
      if (!status) {
        failed = true;
        errors.emplace(i, status.error());
      }
      progress(++done, count);
    }
  };
  {
    std::vector<std::jthread> workers;
    for (std::size_t j = 0; j < std::min(jobs, count); ++j) workers.emplace_back(worker);
  }  // joins
  if (!errors.empty()) return errors.begin()->second;
  return Done{};
}

}  // namespace rfmvo::montecarlo
