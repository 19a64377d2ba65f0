// The reproduction as one page that opens offline.
#pragma once

#include <string>

#include "base/result.hpp"
#include "reproduce/study.hpp"

namespace rfmvo::reproduce {

// Errors: gnuplot.
[[nodiscard]] Result<std::string> make_page(const Options& options, const Results& results);

}  // namespace rfmvo::reproduce
