// What the reader answers: success, or what was wrong, down to the parameter and field. LLRP 1.0.1 section 14.2.
// Names are the standard's; one `fields` per parameter serves decoding and encoding (schema.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "edges/llrp/schema.hpp"

namespace rfmvo::llrp {

struct FieldError {
  static constexpr Name kName{288, "FieldError"};
  std::uint16_t field_num = 0;
  std::uint16_t error_code = 0;
  static void fields(auto& v, auto& s) {
    v.value("FieldNum", s.field_num);
    v.value("ErrorCode", s.error_code);
  }
};

struct ParameterError {
  static constexpr Name kName{289, "ParameterError"};
  std::uint16_t parameter_type = 0;
  std::uint16_t error_code = 0;
  std::optional<FieldError> field_error;
  std::vector<ParameterError> parameter_error;
  static void fields(auto& v, auto& s) {
    v.value("ParameterType", s.parameter_type);
    v.value("ErrorCode", s.error_code);
    v.child(s.field_error);
    v.child(s.parameter_error);
  }
};

struct LLRPStatus {
  static constexpr Name kName{287, "LLRPStatus"};
  std::uint16_t status_code = 0;
  std::string error_description;
  std::optional<FieldError> field_error;
  std::optional<ParameterError> parameter_error;
  static void fields(auto& v, auto& s) {
    v.value("StatusCode", s.status_code);
    v.value("ErrorDescription", s.error_description);
    v.child(s.field_error);
    v.child(s.parameter_error);
  }
};

}  // namespace rfmvo::llrp
