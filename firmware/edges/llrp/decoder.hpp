// Bytes to typed parameters: the visitors of schema.hpp that read. Within the codec only.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "edges/llrp/schema.hpp"

namespace rfmvo::llrp {

// One decoding: where it is, what it passed over, and the first thing that was wrong.
struct Decoding {
  std::vector<std::string_view> path;  // names of the message and parameters around
  std::vector<std::string> skipped;    // unknown parameters
  std::string error;                   // empty: none yet
  std::string where;                   // path to it

  void fail(const std::string& what);
  void skip(std::uint16_t type);
};

// The next parameter's place in `bytes`; fails if there is no whole one.
struct Found {
  std::uint16_t type = 0;
  std::span<const std::uint8_t> body;
  std::size_t size = 0;  // with its header
};
std::optional<Found> find_parameter(std::span<const std::uint8_t> bytes, Decoding& decoding);
bool is_known_parameter(std::uint16_t type);
inline constexpr std::size_t kMaxDepth = 32;  // of parameters in parameters; the standard needs 9

// First pass: the fields in front of the parameters.
class FieldReader {
 public:
  FieldReader(std::span<const std::uint8_t> bytes, Decoding& decoding) : left_(bytes), decoding_(decoding) {}
  [[nodiscard]] std::span<const std::uint8_t> left() const { return left_; }

  void value(std::string_view name, auto& x) { get(name, x); }
  template <class T>
  void bits(std::string_view name, T& x, int count) {
    x = static_cast<T>(get_bits(name, count));
  }
  void reserved(int count) { (void)get_bits("reserved bits", count); }
  void rest(std::string_view, std::vector<std::uint8_t>& x) { x.assign(left_.begin(), left_.end()), left_ = {}; }
  void child(auto&) {}

 private:
  bool take(std::string_view name, std::size_t size, std::span<const std::uint8_t>& taken) {
    if (left_.size() < size) {
      decoding_.fail("ends within " + std::string(name));
      left_ = {};
      return false;
    }
    taken = left_.first(size);
    left_ = left_.subspan(size);
    return true;
  }
  template <std::integral T>
  void get(std::string_view name, T& x) {
    std::span<const std::uint8_t> bytes;
    if (!take(name, sizeof(T), bytes)) return;
    std::make_unsigned_t<T> value = 0;
    for (const std::uint8_t byte : bytes)
      value = static_cast<std::make_unsigned_t<T>>(std::uint64_t{value} << 8 | byte);
    x = static_cast<T>(value);
  }
  void get(std::string_view name, std::string& x) {
    std::uint16_t count = 0;
    get(name, count);
    std::span<const std::uint8_t> bytes;
    if (take(name, count, bytes)) x.assign(bytes.begin(), bytes.end());
  }
  template <class T>
  void get(std::string_view name, std::vector<T>& x) {
    std::uint16_t count = 0;
    get(name, count);
    if (left_.size() < count * sizeof(T)) return decoding_.fail("ends within " + std::string(name));
    x.resize(count);
    for (T& item : x) get(name, item);
  }
  template <std::size_t N>
  void get(std::string_view name, std::array<std::uint8_t, N>& x) {
    std::span<const std::uint8_t> bytes;
    if (take(name, N, bytes)) std::copy(bytes.begin(), bytes.end(), x.begin());
  }
  void get(std::string_view name, BitString& x) {
    get(name, x.bits);
    std::span<const std::uint8_t> bytes;
    if (take(name, (x.bits + 7U) / 8U, bytes))
      x.bytes.assign(bytes.begin(), bytes.end());
    else
      x.bits = 0;
  }
  unsigned get_bits(std::string_view name, int count) {
    for (; pending_count_ < count; pending_count_ += 8) {
      std::uint8_t byte = 0;
      get(name, byte);
      pending_ = pending_ << 8 | byte;
    }
    pending_count_ -= count;
    return pending_ >> pending_count_ & ((1U << count) - 1);
  }

  std::span<const std::uint8_t> left_;
  Decoding& decoding_;
  unsigned pending_ = 0;
  int pending_count_ = 0;
};

template <class T>
void decode_into(T& out, std::span<const std::uint8_t> bytes, Decoding& decoding);

// Second pass, once per parameter: gives it to the member that takes its type.
class ChildPlacer {
 public:
  ChildPlacer(const Found& found, const std::vector<std::uint16_t>& seen, Decoding& decoding)
      : found_(found), seen_(seen), decoding_(decoding) {}
  [[nodiscard]] bool placed() const { return placed_; }

  void value(std::string_view, auto&) {}
  void bits(std::string_view, auto&, int) {}
  void reserved(int) {}
  void rest(std::string_view, auto&) {}

  template <class T>
  void child(std::optional<T>& x) {
    T one;
    if (!place(one)) return;
    if (x) return decoding_.fail(std::string(name_of(one)) + " appears twice");
    x = std::move(one);
  }
  template <class T>
  void child(std::vector<T>& list) {
    T one;
    if (place(one)) list.push_back(std::move(one));
  }
  template <class T>
  void child(T& x) {
    T one;
    if (!place(one)) return;
    if (std::find(seen_.begin(), seen_.end(), found_.type) != seen_.end())
      return decoding_.fail(std::string(name_of(one)) + " appears twice");
    x = std::move(one);
  }

 private:
  template <class T>
  static std::string_view name_of(const T&) {
    return T::kName.text;
  }
  template <class... T>
  static std::string_view name_of(const std::variant<T...>& choice) {
    return std::visit(
        []<class U>(const U&) -> std::string_view {
          if constexpr (std::is_same_v<U, std::monostate>)
            return "";
          else
            return U::kName.text;
        },
        choice);
  }
  template <class T>
  requires requires { T::kName; }
  bool place(T& x) {
    if (placed_ || T::kName.type != found_.type) return false;
    placed_ = true;
    decoding_.path.push_back(T::kName.text);
    decode_into(x, found_.body, decoding_);
    decoding_.path.pop_back();
    return true;
  }
  template <class... T>
  bool place(std::variant<T...>& choice) {
    return (place_alternative<T>(choice) || ...);
  }
  template <class T, class Choice>
  bool place_alternative(Choice& choice) {
    if constexpr (std::is_same_v<T, std::monostate>) {
      return false;
    } else {
      T one;
      if (!place(one)) return false;
      choice = std::move(one);
      return true;
    }
  }

  const Found& found_;
  const std::vector<std::uint16_t>& seen_;
  Decoding& decoding_;
  bool placed_ = false;
};

// Last pass: what must be there.
class RequiredCheck {
 public:
  RequiredCheck(const std::vector<std::uint16_t>& seen, Decoding& decoding) : seen_(seen), decoding_(decoding) {}
  void value(std::string_view, auto&) {}
  void bits(std::string_view, auto&, int) {}
  void reserved(int) {}
  void rest(std::string_view, auto&) {}
  template <class T>
  void child(std::optional<T>&) {}
  template <class T>
  void child(std::vector<T>&) {}
  template <class First, class... T>
  void child(std::variant<First, T...>& choice) {
    if (!std::is_same_v<First, std::monostate> || choice.index() != 0) return;
    std::string names;
    ((names += (names.empty() ? "" : " or ") + std::string(T::kName.text)), ...);
    decoding_.fail(names + " is missing");
  }
  template <class T>
  requires requires { T::kName; }
  void child(T&) {
    if (std::find(seen_.begin(), seen_.end(), T::kName.type) == seen_.end())
      decoding_.fail(std::string(T::kName.text) + " is missing");
  }

 private:
  const std::vector<std::uint16_t>& seen_;
  Decoding& decoding_;
};

template <class T>
void decode_into(T& out, std::span<const std::uint8_t> bytes, Decoding& decoding) {
  if (decoding.path.size() > kMaxDepth) return decoding.fail("parameters are nested too deep");
  FieldReader fields(bytes, decoding);
  T::fields(fields, out);
  std::span<const std::uint8_t> left = fields.left();
  std::vector<std::uint16_t> seen;
  while (decoding.error.empty() && !left.empty()) {
    const auto found = find_parameter(left, decoding);
    if (!found) return;
    ChildPlacer placer(*found, seen, decoding);
    T::fields(placer, out);
    if (!placer.placed()) decoding.skip(found->type);
    seen.push_back(found->type);
    left = left.subspan(found->size);
  }
  if (!decoding.error.empty()) return;
  RequiredCheck check(seen, decoding);
  T::fields(check, out);
}

}  // namespace rfmvo::llrp
