// Text for HTML.
#pragma once

#include <string>
#include <string_view>

namespace rfmvo::report {

// Safe as element content and as attribute value: the five special characters as entities; control
// characters and bytes that are no UTF-8 as U+FFFD.
[[nodiscard]] std::string escape(std::string_view text);

}  // namespace rfmvo::report
