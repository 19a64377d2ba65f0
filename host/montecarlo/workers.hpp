// Independent pieces of work on a few threads.
#pragma once

#include <cstddef>
#include <functional>

#include "base/result.hpp"

namespace rfmvo::montecarlo {

// After each finished piece, from one thread at a time.
using Progress = std::function<void(std::size_t done, std::size_t all)>;

// work(0) .. work(count - 1), up to `jobs` at a time. After an error nothing more is begun; of several errors the one
// of the smallest number is returned.
[[nodiscard]] Status in_parallel(std::size_t count, std::size_t jobs, const std::function<Status(std::size_t)>& work,
                                 const Progress& progress);

}  // namespace rfmvo::montecarlo
