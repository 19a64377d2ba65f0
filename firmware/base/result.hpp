// A value, or one clear error that names the culprit (file, key, offset): for trouble that comes
// from outside the program.
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "base/assert.hpp"

namespace rfmvo {

enum class ErrorCode { kNotFound, kUnreadable, kUnwritable, kMalformed, kUnknownKey, kOutOfRange, kUnsupported };

struct Error {
  ErrorCode code = ErrorCode::kMalformed;
  std::string what;   // what is wrong, in words
  std::string where;  // file, file:line, key, byte offset

  [[nodiscard]] std::string text() const { return where.empty() ? what : where + ": " + what; }
};

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(content_); }
  explicit operator bool() const { return ok(); }

  [[nodiscard]] const T& value() const& {
    RFMVO_ASSERT(ok());
    return std::get<T>(content_);
  }
  [[nodiscard]] T&& value() && {
    RFMVO_ASSERT(ok());
    return std::get<T>(std::move(content_));
  }
  [[nodiscard]] const Error& error() const {
    RFMVO_ASSERT(!ok());
    return std::get<Error>(content_);
  }

 private:
  std::variant<T, Error> content_;
};

struct Done {};
using Status = Result<Done>;

}  // namespace rfmvo
