// The reproduction as one page that opens offline.
#pragma once

#include <string>

#include "base/result.hpp"
#include "reproduce/results.hpp"

namespace rfmvo::reproduce {

// Errors: gnuplot.
[[nodiscard]] Result<std::string> make_page(const Results& results);

}  // namespace rfmvo::reproduce
