// Small text files: configuration, calibration, lists.
#pragma once

#include <string>

#include "base/result.hpp"

namespace rfmvo {

// Errors: kNotFound, kUnreadable; a file above 16 MB is kMalformed.
[[nodiscard]] Result<std::string> read_text_file(const std::string& path);

}  // namespace rfmvo
