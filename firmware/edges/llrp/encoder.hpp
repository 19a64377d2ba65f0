// Typed parameters to bytes: the visitor of schema.hpp that writes. Within the codec only.
#pragma once

#include <array>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/assert.hpp"
#include "edges/llrp/schema.hpp"

namespace rfmvo::llrp {

class Encoder {
 public:
  void value(std::string_view, const auto& x) { put(x); }
  void bits(std::string_view, std::unsigned_integral auto x, int count) { put_bits(x, count); }
  void reserved(int count) { put_bits(0, count); }
  void rest(std::string_view, const std::vector<std::uint8_t>& bytes) { append(bytes.begin(), bytes.end()); }

  template <class T>
  void child(const std::optional<T>& x) {
    if (x) child(*x);
  }
  template <class T>
  void child(const std::vector<T>& list) {
    for (const T& x : list) child(x);
  }
  template <class... T>
  void child(const std::variant<T...>& choice) {
    std::visit(
        [this](const auto& x) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(x)>, std::monostate>) this->child(x);
        },
        choice);
  }
  template <class T>
  requires requires { T::kName; }
  void child(const T& x) {
    constexpr std::uint16_t kType = T::kName.type;
    if constexpr (kType < 128) {
      put(static_cast<std::uint8_t>(0x80U | kType));
      T::fields(*this, x);
    } else {
      const std::size_t start = bytes_.size();
      put(kType);
      put(std::uint16_t{0});
      T::fields(*this, x);
      patch(start + 2, bytes_.size() - start, 2);
    }
  }

  void put(std::unsigned_integral auto x) {
    for (int shift = 8 * (sizeof(x) - 1); shift >= 0; shift -= 8)
      bytes_.push_back(static_cast<std::uint8_t>(x >> shift));
  }
  // Writes x over the `size` bytes at `offset`. The bound of what the wire can hold is a bug of the caller.
  void patch(std::size_t offset, std::size_t x, std::size_t size) {
    RFMVO_ASSERT(size >= sizeof(x) || x >> (8 * size) == 0);
    for (std::size_t i = 0; i < size; ++i) bytes_[offset + i] = static_cast<std::uint8_t>(x >> (8 * (size - 1 - i)));
  }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] std::vector<std::uint8_t> take() && { return std::move(bytes_); }

 private:
  void append(auto first, auto last) { bytes_.insert(bytes_.end(), first, last); }
  void put(std::signed_integral auto x) { put(static_cast<std::make_unsigned_t<decltype(x)>>(x)); }
  void put_count(std::size_t count) {
    RFMVO_ASSERT(count <= 0xFFFF);
    put(static_cast<std::uint16_t>(count));
  }
  void put(const std::string& text) {
    put_count(text.size());
    append(text.begin(), text.end());
  }
  template <std::unsigned_integral T>
  void put(const std::vector<T>& list) {
    put_count(list.size());
    for (const T x : list) put(x);
  }
  template <std::size_t N>
  void put(const std::array<std::uint8_t, N>& bytes) {
    append(bytes.begin(), bytes.end());
  }
  void put(const BitString& x) {
    RFMVO_ASSERT(x.bytes.size() == (x.bits + 7U) / 8U);
    put(x.bits);
    append(x.bytes.begin(), x.bytes.end());
  }
  void put_bits(unsigned x, int count) {
    pending_ = pending_ << count | (x & ((1U << count) - 1));
    pending_count_ += count;
    for (; pending_count_ >= 8; pending_count_ -= 8)
      bytes_.push_back(static_cast<std::uint8_t>(pending_ >> (pending_count_ - 8)));
  }

  std::vector<std::uint8_t> bytes_;
  unsigned pending_ = 0;
  int pending_count_ = 0;
};

}  // namespace rfmvo::llrp
