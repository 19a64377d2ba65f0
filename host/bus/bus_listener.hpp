// Everything that is said on an LCM bus, and how much of it was missed.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"

namespace rfmvo {

struct BusMessage {
  std::string channel;
  std::vector<std::uint8_t> data;
};

// Of messages of all channels, since the listener was opened.
struct BusLoss {
  bool counted = true;             // false: this kind of bus has no sequence numbers
  std::uint64_t messages = 0;      // numbers that a sender used and that did not come, whole
  std::uint64_t dropped_here = 0;  // datagrams that this machine had no room for: part of the above
};

class BusListener {
 public:
  virtual ~BusListener() = default;
  // The next message; nothing if none comes within `timeout`. A signal ends the wait at once. Errors: the bus broke.
  [[nodiscard]] virtual Result<std::optional<BusMessage>> next(Duration timeout) = 0;
  [[nodiscard]] virtual BusLoss loss() const = 0;
};

// udpm: urls are listened to on a socket of our own, because liblcm does not tell the senders' sequence numbers;
// all others through liblcm. Errors: kUnsupported, kMalformed naming the url.
[[nodiscard]] Result<std::unique_ptr<BusListener>> open_bus_listener(const std::string& url);

}  // namespace rfmvo
