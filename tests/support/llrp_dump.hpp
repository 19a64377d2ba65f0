// A decoded message as nested lists [name, [[field, value], [child, [...]], ...]]: one more visitor of schema.hpp,
// for tests that compare with other people's texts.
#pragma once

#include <nlohmann/json.hpp>

#include "edges/llrp/codec.hpp"

namespace rfmvo::testing {

class LlrpDump {
 public:
  nlohmann::json list = nlohmann::json::array();

  void value(std::string_view name, const auto& x) { put(name, x); }
  void bits(std::string_view name, const auto& x, int) { put(name, static_cast<unsigned>(x)); }
  void reserved(int) {}
  void rest(std::string_view name, const std::vector<std::uint8_t>& bytes) { put(name, bytes); }
  template <class T>
  void child(const std::optional<T>& x) {
    if (x) child(*x);
  }
  template <class T>
  void child(const std::vector<T>& all) {
    for (const T& x : all) child(x);
  }
  template <class... T>
  void child(const std::variant<T...>& choice) {
    std::visit(
        [this]<class U>(const U& x) {
          if constexpr (!std::is_same_v<U, std::monostate>) this->child(x);
        },
        choice);
  }
  template <class T>
  requires requires { T::kName; }
  void child(const T& x) {
    LlrpDump inner;
    T::fields(inner, x);
    put(T::kName.text, inner.list);
  }

 private:
  void put(std::string_view name, const llrp::BitString& x) { put(name, x.bytes); }
  void put(std::string_view name, const nlohmann::json& x) { list.push_back({std::string(name), x}); }
};

// Null for messages whose body is not looked into.
[[nodiscard]] inline nlohmann::json dump(const llrp::Message& message) {
  return std::visit(
      [&]<class T>(const T& body) -> nlohmann::json {
        if constexpr (std::is_same_v<T, llrp::RawMessage>) {
          return nullptr;
        } else {
          LlrpDump fields;
          T::fields(fields, body);
          return {std::string(T::kName.text), fields.list, message.id};
        }
      },
      message.body);
}

}  // namespace rfmvo::testing
