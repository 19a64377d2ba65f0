// What the codec knows of parameters by their number, and what a status says in words.
#include "edges/llrp/parameters.hpp"

#include <array>

#include "edges/llrp/codec.hpp"
#include "edges/llrp/decoder.hpp"
#include "edges/llrp/encoder.hpp"

namespace rfmvo::llrp {
namespace {

constexpr std::size_t kTvHeaderBytes = 1, kTlvHeaderBytes = 4;
constexpr std::uint16_t kFirstTlv = 128, kTypeMask = 0x3FF;

template <class... T>
std::string_view find_name(std::uint16_t type, TypeList<T...>) {
  std::string_view name;
  ((T::kName.type == type ? void(name = T::kName.text) : void()), ...);
  return name;
}

template <class T>
void note_tv_size(std::array<std::size_t, kFirstTlv>& sizes) {
  if constexpr (T::kName.type < kFirstTlv) {
    Encoder encoder;
    encoder.child(T{});
    sizes[T::kName.type] = encoder.size() - kTvHeaderBytes;
  }
}

// Bytes after the first one; TV parameters have fixed fields. 0: no such type.
template <class... T>
std::array<std::size_t, kFirstTlv> tv_sizes(TypeList<T...>) {
  std::array<std::size_t, kFirstTlv> sizes{};
  (note_tv_size<T>(sizes), ...);
  return sizes;
}

struct StatusCode {
  std::uint16_t code;
  std::string_view name;
};
// LLRP 1.0.1 section 14.2.1.
constexpr StatusCode kStatusCodes[] = {{0, "M_Success"},
                                       {100, "M_ParameterError"},
                                       {101, "M_FieldError"},
                                       {102, "M_UnexpectedParameter"},
                                       {103, "M_MissingParameter"},
                                       {104, "M_DuplicateParameter"},
                                       {105, "M_OverflowParameter"},
                                       {106, "M_OverflowField"},
                                       {107, "M_UnknownParameter"},
                                       {108, "M_UnknownField"},
                                       {109, "M_UnsupportedMessage"},
                                       {110, "M_UnsupportedVersion"},
                                       {111, "M_UnsupportedParameter"},
                                       {200, "P_ParameterError"},
                                       {201, "P_FieldError"},
                                       {202, "P_UnexpectedParameter"},
                                       {203, "P_MissingParameter"},
                                       {204, "P_DuplicateParameter"},
                                       {205, "P_OverflowParameter"},
                                       {206, "P_OverflowField"},
                                       {207, "P_UnknownParameter"},
                                       {208, "P_UnknownField"},
                                       {209, "P_UnsupportedParameter"},
                                       {300, "A_Invalid"},
                                       {301, "A_OutOfRange"},
                                       {401, "R_DeviceError"}};

std::string text_of(const FieldError& error) {
  return ", field " + std::to_string(error.field_num) + " (" + status_code_name(error.error_code) + ")";
}

std::string text_of(const ParameterError& error) {
  std::string text = parameter_name(error.parameter_type) + " (" + status_code_name(error.error_code) + ")";
  if (error.field_error) text += text_of(*error.field_error);
  for (const ParameterError& inner : error.parameter_error) text += " in it " + text_of(inner);
  return text;
}

}  // namespace

void Decoding::fail(const std::string& what) {
  if (!error.empty()) return;
  error = what;
  for (const std::string_view name : path) where += (where.empty() ? "" : ".") + std::string(name);
}

void Decoding::skip(std::uint16_t type) {
  if (is_known_parameter(type)) return fail(parameter_name(type) + " has no place here");
  skipped.push_back(std::string(path.back()) + ": unknown parameter " + std::to_string(type));
}

bool is_known_parameter(std::uint16_t type) { return !find_name(type, Parameters{}).empty(); }

std::optional<Found> find_parameter(std::span<const std::uint8_t> bytes, Decoding& decoding) {
  static const auto kTvSizes = tv_sizes(Parameters{});
  Found found;
  if ((bytes[0] & 0x80U) != 0) {
    found.type = bytes[0] & 0x7FU;
    const std::size_t size = kTvSizes[found.type];
    if (size == 0) return decoding.fail("unknown TV parameter " + std::to_string(found.type)), std::nullopt;
    found.size = kTvHeaderBytes + size;
    if (bytes.size() < found.size) return decoding.fail("ends within " + parameter_name(found.type)), std::nullopt;
    found.body = bytes.subspan(kTvHeaderBytes, size);
    return found;
  }
  if (bytes.size() < kTlvHeaderBytes) return decoding.fail("ends within a parameter's header"), std::nullopt;
  found.type = static_cast<std::uint16_t>((bytes[0] * 256U + bytes[1]) & kTypeMask);
  found.size = bytes[2] * 256U + bytes[3];
  if (found.size < kTlvHeaderBytes || found.size > bytes.size())
    return decoding.fail(parameter_name(found.type) + ": length " + std::to_string(found.size) +
                         " does not fit into the " + std::to_string(bytes.size()) + " bytes left"),
           std::nullopt;
  found.body = bytes.subspan(kTlvHeaderBytes, found.size - kTlvHeaderBytes);
  return found;
}

std::string parameter_name(std::uint16_t type) {
  const std::string_view name = find_name(type, Parameters{});
  return name.empty() ? "parameter " + std::to_string(type) : std::string(name);
}

std::string status_code_name(std::uint16_t code) {
  for (const StatusCode& known : kStatusCodes)
    if (known.code == code) return std::string(known.name);
  return "status " + std::to_string(code);
}

std::string status_text(const LLRPStatus& status) {
  std::string text = status_code_name(status.status_code);
  if (status.parameter_error) text += ": " + text_of(*status.parameter_error);
  if (status.field_error) text += text_of(*status.field_error);
  if (!status.error_description.empty()) text += ": " + status.error_description;
  return text;
}

}  // namespace rfmvo::llrp
