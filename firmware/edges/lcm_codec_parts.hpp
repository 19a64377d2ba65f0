// What the event codec and the estimate codec share: checked fields of LCM messages. Not for others.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "edges/lcm_codec.hpp"
#include "rfmvo/camera_pose_t.hpp"
#include "rfmvo/reader_status_t.hpp"

namespace rfmvo::codec {

// Quaternions are written in double by ourselves; float writers stay within this of length 1.
inline constexpr double kUnitTolerance = 1e-6;
inline constexpr std::int64_t kMaxUtime = std::numeric_limits<std::int64_t>::max() / 1000;  // fits nanoseconds

inline Error malformed(std::string what, std::string_view channel) {
  return {ErrorCode::kMalformed, std::move(what), std::string(channel)};
}

template <class Message>
LcmMessage pack(const Message& message, std::string_view prefix, std::string_view name) {
  LcmMessage out{std::string(prefix) + std::string(name), message.utime, {}};
  out.data.resize(static_cast<std::size_t>(message.getEncodedSize()));
  const int written = message.encode(out.data.data(), 0, static_cast<int>(out.data.size()));
  RFMVO_ASSERT(written == static_cast<int>(out.data.size()));
  return out;
}

// Big-endian int32 at `offset`; -1 if it is not there.
inline std::int64_t peek_int32(std::span<const std::uint8_t> data, std::size_t offset) {
  if (offset + 4 > data.size()) return -1;
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | data[offset + i];
  return static_cast<std::int32_t>(value);
}

// The generated decoders allocate what a length field says before they look whether it is there: so
// look first. `element_size` in bytes on the wire.
inline bool holds_array(std::span<const std::uint8_t> data, std::size_t count_offset, std::size_t element_size) {
  const std::int64_t count = peek_int32(data, count_offset);
  return count >= 0 && static_cast<std::size_t>(count) <= (data.size() - count_offset - 4) / element_size;
}

// Consecutive strings of a message. The generated decoders compute with a length of 0 or below as if it were one.
struct StringsAt {
  std::size_t offset = 0;
  int count = 0;
};
inline bool holds_strings(std::span<const std::uint8_t> data, StringsAt strings) {
  for (; strings.count > 0; --strings.count) {
    if (!holds_array(data, strings.offset, 1)) return false;
    const std::int64_t length = peek_int32(data, strings.offset);  // with the final NUL
    if (length < 1) return false;
    strings.offset += 4 + static_cast<std::size_t>(length);
  }
  return true;
}

// `strings`: of the message; its arrays are for the caller to look at.
template <class Message>
Status unpack(Message& message, std::span<const std::uint8_t> data, std::string_view channel, StringsAt strings = {}) {
  int used = -1;
  if (data.size() <= static_cast<std::size_t>(std::numeric_limits<int>::max()) && holds_strings(data, strings))
    used = message.decode(data.data(), 0, static_cast<int>(data.size()));
  if (used < 0 || static_cast<std::size_t>(used) != data.size())
    return malformed(std::string("not a whole rfmvo.") + Message::getTypeName() + " message of this version", channel);
  if (message.utime > kMaxUtime || message.utime < -kMaxUtime) return malformed("utime is out of range", channel);
  return Done{};
}

template <std::size_t N>
bool finite(const double (&values)[N]) {
  for (const double x : values)
    if (!std::isfinite(x)) return false;
  return true;
}

// Matrices row by row.
template <std::size_t N, class Derived>
void put(double (&out)[N], const Eigen::MatrixBase<Derived>& m) {
  static_assert(N == static_cast<std::size_t>(Derived::SizeAtCompileTime));
  std::size_t i = 0;
  for (Eigen::Index r = 0; r < m.rows(); ++r)
    for (Eigen::Index c = 0; c < m.cols(); ++c) out[i++] = m(r, c);
}

inline void put(double (&out)[4], const Eigen::Quaterniond& q) {
  out[0] = q.w();
  out[1] = q.x();
  out[2] = q.y();
  out[3] = q.z();
}

inline Eigen::Vector3d vector_of(const double (&a)[3]) { return {a[0], a[1], a[2]}; }

template <std::size_t Size>
auto matrix_of(const double (&a)[Size]) {
  constexpr int kSide = Size == 9 ? 3 : 6;
  static_assert(Size == kSide * kSide);
  return Eigen::Matrix<double, kSide, kSide>(Eigen::Map<const Eigen::Matrix<double, kSide, kSide, Eigen::RowMajor>>(a));
}

// Not normalised here: what was written must come back to the last bit.
inline Eigen::Quaterniond quaternion_of(const double (&a)[4]) { return {a[0], a[1], a[2], a[3]}; }
inline bool is_unit(const double (&a)[4]) {
  return finite(a) && std::abs(quaternion_of(a).norm() - 1.0) <= kUnitTolerance;
}

template <class Unsigned>
bool fits(std::int64_t x) {
  return x >= 0 && (sizeof(Unsigned) >= 8 || x <= static_cast<std::int64_t>(std::numeric_limits<Unsigned>::max()));
}

camera_pose_t message_of(const CameraPose& pose);
Result<CameraPose> camera_pose_of(const camera_pose_t& message, std::string_view channel);
reader_status_t message_of(const ReaderStatus& status);
Result<ReaderStatus> reader_status_of(const reader_status_t& message, std::string_view channel);

}  // namespace rfmvo::codec
