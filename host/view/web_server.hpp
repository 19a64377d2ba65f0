// A page and what it is told: HTTP and WebSocket on one port, in the caller's thread, by libwebsockets.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "base/result.hpp"

namespace rfmvo::view {

struct WebSettings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;  // 0: any free one
  std::string token;          // not empty: nobody gets anything without it
};

// The newest message of each kind goes to every page; what a slow page misses, it misses.
enum class Slot : std::size_t { kStatus, kMap, kOverlay, kPicture };
inline constexpr std::size_t kSlots = 4;

class WebServer {
 public:
  // Without a token, requests are only answered that name this machine itself in their Host, and pages of other
  // origins get no WebSocket. Errors: kUnsupported naming address and port.
  [[nodiscard]] static Result<std::unique_ptr<WebServer>> create(const WebSettings& settings, std::string page);
  ~WebServer();

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] std::size_t pages() const;  // that are connected
  // For publish() from within `tick`, only.
  void publish(Slot slot, std::string message);
  // Serves; calls `tick` ten times a second, until it says false.
  void run(const std::function<bool()>& tick);

 private:
  struct Impl;
  explicit WebServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// An address of this machine alone: 127.0.0.0/8, ::1, localhost.
[[nodiscard]] bool is_loopback(const std::string& address);
// 128 random bits as hex.
[[nodiscard]] std::string random_token();

}  // namespace rfmvo::view
